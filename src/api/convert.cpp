#include "clearway/convert.hpp"

#include "core/util/callback_progress.hpp"
#include "core/util/message_log.hpp"
#include "io/convert/convert.hpp"
#include "io/store/store_reader.hpp"

namespace clearway {

ConvertReport convert(const std::vector<std::filesystem::path>& inputs,
                      const std::filesystem::path& output, const ConvertOptions& options) {
  const ConversionOptions conversion{options, inputs, output};
  CallbackProgress progress(options.progress, options.stop);
  if (options.resume && is_converted(conversion, progress)) {
    ConvertReport report{.was_finished = true};
    MessageLog log(options.message, report.warnings);
    const StoreReader store(output);
    for (const Message& warning : store.metadata().warnings) log.add(warning);
    if (options.strict) refuse_warnings(report.warnings);
    return report;
  }
  return convert_scans(conversion, progress);
}

}  // namespace clearway
