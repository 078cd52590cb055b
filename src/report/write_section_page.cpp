#include <span>
#include <string>

#include "clearway/report.hpp"
#include "io/files/file.hpp"
#include "io/files/pending_file.hpp"
#include "io/files/thread_limit.hpp"
#include "report/section_view.hpp"

namespace clearway {
namespace {

std::string title_of(const SectionPageOptions& options) {
  if (!options.title.empty()) return options.title;
  const std::string name = options.section_name.empty() ? "the route" : options.section_name;
  return options.outline_name.empty() ? "Section of " + name : options.outline_name + " in " + name;
}

Json json_of_warnings(const SectionView& view, const SectionPageOptions& options) {
  Json out = Json::array();
  const auto add = [&](const Message& warning) {
    out.push_back({{"code", warning.code}, {"message", warning.text}});
  };
  for (const Message& warning : view.section.data().warnings) add(warning);
  for (const Message& warning : options.warnings) {
    if (warning.severity == Message::Severity::kWarning) add(warning);
  }
  return out;
}

}  // namespace

SectionPageSummary write_section_page(const Section& section, const std::filesystem::path& output,
                                      const SectionPageOptions& options) {
  PendingFile file(output, options.overwrite);
  const SectionView view(section, options);
  const std::string title = title_of(options);
  Json facts = page_head(options, title);
  facts["unit"] = section.data().length_unit;
  facts["warnings"] = json_of_warnings(view, options);
  facts["section"] = view.facts();
  SectionPageSummary summary{.check = view.check, .sentence = view.sentence()};
  summary.facts = page_text(facts);
  PageContent content{
      .title = title, .facts = summary.facts, .section = section_svg(view, false), .columns = {}};
  summary.bytes = in_all_threads([&] {
    view.add_columns(content.columns);
    return write_page(file.partial(), kSectionPage, std::move(content));
  });
  file.publish();
  return summary;
}

void write_section_picture(const Section& section, const std::filesystem::path& output,
                           const SectionPicture& picture, bool overwrite) {
  PendingFile pending(output, overwrite);
  {
    const SectionView view(section, picture);
    const std::string svg =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" + section_svg(view, true);
    File::create(pending.partial()).write(std::as_bytes(std::span(svg)));
  }
  pending.publish();
}

}  // namespace clearway
