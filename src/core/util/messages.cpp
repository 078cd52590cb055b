#include "core/util/messages.hpp"

#include <cstdint>
#include <map>
#include <string>

#include "core/util/format.hpp"

namespace clearway {
namespace {

constexpr std::uint64_t kMostOfACode = 3;

}  // namespace

void shorten_notes(std::vector<Message>& messages) {
  std::map<std::string, std::uint64_t> counts;
  std::erase_if(messages, [&](const Message& message) {
    return message.severity == Message::Severity::kNote && ++counts[message.code] > kMostOfACode;
  });
  for (const auto& [code, count] : counts) {
    if (count <= kMostOfACode) continue;
    const std::uint64_t more = count - kMostOfACode;
    messages.push_back({Message::Severity::kNote,
                        code,
                        format_count(more) + " more notes like these (" + code + ")",
                        {{"more", static_cast<double>(more)}}});
  }
}

}  // namespace clearway
