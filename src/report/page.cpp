#include "report/page.hpp"

#include <span>
#include <string_view>

#include "io/conflicts/markup_text.hpp"
#include "io/system/file.hpp"
#include "report/page_parts.hpp"

namespace clearway {
namespace {

class PageFile {
 public:
  explicit PageFile(const std::filesystem::path& path) : file_(File::create(path)) {}

  void write(std::string_view text) {
    file_.write(std::as_bytes(std::span(text)));
    bytes_ += text.size();
  }
  std::uint64_t bytes() const { return bytes_; }

 private:
  File file_;
  std::uint64_t bytes_ = 0;
};

void write_place(PageFile& file, std::string_view name, const std::string& title,
                 const std::string& facts, const std::vector<PageColumn>& columns) {
  if (name == "TITLE") file.write(markup_text(title));
  if (name == "STYLE") file.write(page_parts::kStyle);
  if (name == "SCRIPT") file.write(page_parts::kScript);
  if (name == "FACTS") file.write(facts);
  if (name != "COLUMNS") return;
  for (const PageColumn& column : columns) {
    file.write(R"(<script type="text/plain" data-column=")" + column.name + R"(">)");
    file.write(column.base64);
    file.write("</script>\n");
  }
}

}  // namespace

std::uint64_t write_page(const std::filesystem::path& path, const std::string& title,
                         const std::string& facts, const std::vector<PageColumn>& columns) {
  PageFile file(path);
  std::string_view rest = page_parts::kHtml;
  constexpr std::string_view kOpen = "{{", kClose = "}}";
  while (true) {
    const std::size_t open = rest.find(kOpen), close = rest.find(kClose);
    if (open == std::string_view::npos) break;
    file.write(rest.substr(0, open));
    write_place(file, rest.substr(open + 2, close - open - 2), title, facts, columns);
    rest.remove_prefix(close + kClose.size());
  }
  file.write(rest);
  return file.bytes();
}

}  // namespace clearway
