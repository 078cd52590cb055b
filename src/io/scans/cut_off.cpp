#include "io/scans/cut_off.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/messages/messages.hpp"
#include "core/util/format.hpp"

namespace clearway {

bool is_chosen_scale(double scale) {
  constexpr double kFoot = 0.3048, kUsSurveyFoot = 1200.0 / 3937.0;
  constexpr int kDigits = 4;
  return std::ranges::any_of(std::array{1.0, kFoot, kUsSurveyFoot}, [&](double unit) {
    const double value = scale / unit;
    return std::abs(std::atof(format_digits(value, kDigits).c_str()) - value) <= 1e-8 * value;
  });
}

void CutOffWarning::add(const std::string& name, const CutOff& found,
                        const std::array<double, 3>& scales) {
  std::string text;
  for (std::size_t k = 0; k < 3; ++k) {
    if (!is_chosen_scale(scales[k])) continue;
    for (const auto& [points, end] :
         {std::pair{found.lowest[k], "lowest "}, std::pair{found.greatest[k], "greatest "}}) {
      if (points < 2) continue;
      points_[k] += points;
      text +=
          (text.empty() ? "" : " and ") + format_count(points) + " points at the " + end + "xyz"[k];
    }
  }
  if (!text.empty() && files_++ == 0) first_ = name + ": has " + text;
}

std::optional<Message> CutOffWarning::message() const {
  if (files_ == 0) return std::nullopt;
  std::string text = first_ + " that 32-bit integers can hold: a program cut off what lies beyond";
  if (files_ > 1) text += ". " + format_count(files_ - 1) + " more are alike";
  return warning("cut-off",
                 text +
                     ". These points stood elsewhere. Export the scan again with an offset near "
                     "it, or with coarser steps",
                 {{"x", points_[0]}, {"y", points_[1]}, {"z", points_[2]}, {"files", files_}});
}

}  // namespace clearway
