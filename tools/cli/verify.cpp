#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "clearway/error.hpp"
#include "cli/commands.hpp"
#include "cli/support/console.hpp"
#include "cli/support/options.hpp"
#include "cli/support/program_json.hpp"
#include "io/files/json.hpp"
#include "io/result/check_results.hpp"
#include "io/result/journal.hpp"
#include "io/section/section_file.hpp"
#include "io/store/file_kind.hpp"
#include "io/store/verify_store.hpp"
#include "stream/search_journal.hpp"

namespace clearway::tool {
namespace {

struct Findings {
  std::vector<std::string> faults;
  std::string remark{};  ///< something worth saying that is no fault
};

/// Whether the file is an empty journal, as left by a run that was killed before the first byte.
bool is_empty_journal(const std::filesystem::path& file) {
  std::error_code unknown;
  return file.extension() == ".journal" && std::filesystem::is_regular_file(file, unknown) &&
         std::filesystem::is_empty(file, unknown);
}

/// Checks a journal. A torn tail is no fault: a run that was killed leaves it, and the next one
/// cuts it off.
Findings verify_journal(const std::filesystem::path& file) {
  const JournalReader journal(file);
  answered_cells(journal);
  if (journal.torn().empty()) return {};
  return {{},
          file.string() + ": " + journal.torn() + "; --resume cuts that off and computes it again"};
}

Findings findings_of(const std::filesystem::path& file) {
  ConsoleProgress progress;
  try {
    if (is_journal(file) || is_empty_journal(file)) return verify_journal(file);
    const FileKind kind = describe_file(file).kind;
    if (kind == FileKind::kResult) {
      if (const auto fault = verify_result(ResultReader(file, Parts::kAccepted), progress))
        return {{*fault}};
      return {};
    }
    if (kind == FileKind::kSection) {
      read_section(file);
      return {};
    }
    return {verify_store(StoreReader(file), progress)};
  } catch (const InputError& fault) {
    return {{fault.what()}};
  }
}

struct VerifyOptions {
  std::filesystem::path file;
  bool json = false;
};

bool run_verify(const VerifyOptions& options) {
  const Findings found = findings_of(options.file);
  const bool sound = found.faults.empty();
  if (options.json) {
    nlohmann::ordered_json out = program_json({{"file", options.file}});
    out["sound"] = sound;
    out["faults"] = found.faults;
    out["remark"] = nullptr;
    if (!found.remark.empty()) out["remark"] = found.remark;
    print(indented_text(out));
    return sound;
  }
  for (const std::string& fault : found.faults) print(fault + "\n");
  if (!found.remark.empty()) print(found.remark + "\n");
  print(options.file.string() + (sound ? ": sound\n" : ": damaged\n"));
  return sound;
}

}  // namespace

void add_verify(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<VerifyOptions>();
  CLI::App* command = program.add_subcommand(
      "verify", "Re-read and check everything in a store, a result, a section or a journal");
  add_file(*command, "FILE", options->file, "Store, result, section or journal")->required();
  command->add_flag("--json", options->json, "Print one JSON object");
  command->footer(
      "Names every damaged cell (at most 20), or the first damaged record of a journal.\n"
      "A killed run can leave a torn tail: such a journal is sound, and the tail is named.\n"
      "Exit code 0: sound.\n"
      "Exit code 1: damaged, or not a complete store, result or section.\n"
      "Exit code 4: the file cannot be opened.\n"
      "Example: clearway verify site.h5");
  command->callback([options, &exit_code] { exit_code = run_verify(*options) ? 0 : 1; });
}

}  // namespace clearway::tool
