#include "clearway/convert.hpp"

#include "core/util/callback_progress.hpp"
#include "io/convert/convert.hpp"

namespace clearway {

ConvertReport convert(const std::vector<std::filesystem::path>& inputs,
                      const std::filesystem::path& output, const ConvertOptions& options) {
  const ConversionOptions conversion{options, inputs, output};
  CallbackProgress progress(options.progress, options.stop);
  if (options.resume && is_converted(conversion, progress)) return {.was_finished = true};
  return convert_scans(conversion, progress);
}

}  // namespace clearway
