#include "clearway/convert.hpp"

#include "core/util/callback_progress.hpp"
#include "core/util/message_log.hpp"
#include "io/convert/convert.hpp"

namespace clearway {

ConvertReport convert(const std::vector<std::filesystem::path>& inputs,
                      const std::filesystem::path& output, const ConvertOptions& options) {
  const ConversionOptions conversion{options, inputs, output};
  CallbackProgress progress(options.progress, options.stop);
  ConvertReport report;
  if (options.resume && is_converted(conversion, progress)) {
    report.was_finished = true;
    return report;
  }
  report = convert_scans(conversion, progress);
  if (options.message) {
    for (const Message& warning : report.warnings) options.message(warning);
  }
  return report;
}

}  // namespace clearway
