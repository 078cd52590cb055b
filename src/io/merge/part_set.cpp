#include "io/merge/part_set.hpp"

#include <algorithm>
#include <string>

#include "clearway/error.hpp"
#include "core/util/number_ranges.hpp"
#include "io/result/answer.hpp"
#include "io/result/check/compare_results.hpp"
#include "io/system/input_error.hpp"
#include "io/system/open_files.hpp"
#include "io/system/xxh64.hpp"

namespace clearway {
namespace {

const Shard& shard_of(const ResultReader& part) { return part.header().part->shard; }

std::string part_text(const ResultReader& part) { return in_words(shard_of(part)); }

ResultReader open_part(const std::filesystem::path& file) {
  ResultReader part(file, Parts::kAccepted);
  if (!part.header().part) {
    refuse(part.name(), "is a whole result; expected a part, as clearway run --shard writes it");
  }
  return part;
}

std::string environment_text(const ResultHeader& header) {
  return std::to_string(header.environment_points) + " points, hash " +
         hash_text(header.environment_hash);
}

/// The difference in how two parts were computed where this may change the answer: with a
/// tolerance, or in single precision alone.
std::string difference_of_means(const ResultReader& part, const ResultReader& other) {
  const ResultPart &a = *part.header().part, &b = *other.header().part;
  const bool floats = part.header().float_precision;
  std::string differs;
  const auto compare = [&](const char* what, const std::string& in_a, const std::string& in_b) {
    if (differs.empty() && in_a != in_b) differs = std::string(what) + in_a + ", not " + in_b;
  };
  compare("the device ", a.device, b.device);
  compare("a model field with a voxel of ", shown(a.field_voxel) + " m",
          shown(b.field_voxel) + " m");
  compare("a grid cell of ", shown(a.grid_cell) + " m", shown(b.grid_cell) + " m");
  if (differs.empty()) return "";
  return "was computed in another way than " + other.name() + ": with " + differs + ". " +
         (floats ? "In single precision" : "With a tolerance") +
         " the answer depends on it; run all parts in the same way";
}

/// Why two files are not parts of one result; empty where they are.
std::string difference_of(const ResultReader& part, const ResultReader& other) {
  const ResultHeader &a = part.header(), &b = other.header();
  if (a.part->shard.count != b.part->shard.count) {
    return "is " + part_text(part) + ", but " + other.name() + " is " + part_text(other);
  }
  if (environment_text(a) != environment_text(b)) {
    return "is of another environment than " + other.name() + ": " + environment_text(a) +
           ", not " + environment_text(b);
  }
  const auto differences = query_differences(a, b);
  if (!differences.empty()) {
    const QueryDifference& first = differences.front();
    return "answers another question than " + other.name() + ": " + first.what + " is " + first.a +
           ", not " + first.b;
  }
  ResultHeader as_other = a;
  as_other.part = b.part;
  as_other.last_pose = b.last_pose;
  if (as_other != b) return "answers another question than " + other.name();
  if (a.part->division != b.part->division) {
    return "divides the work otherwise than " + other.name() +
           ": the stores differ, or the versions of clearway; run the parts with the same";
  }
  return a.is_exact() ? "" : difference_of_means(part, other);
}

/// Numbers in words: "2" or "2, 5-7", with "..." after many.
std::string numbers_text(const std::vector<std::uint32_t>& numbers) {
  constexpr std::size_t kMostRanges = 10;
  const std::vector<std::string> ranges = number_ranges(numbers);
  std::string text;
  for (std::size_t i = 0; i < std::min(ranges.size(), kMostRanges); ++i) {
    text += (i == 0 ? "" : ", ") + ranges[i];
  }
  return ranges.size() > kMostRanges ? text + ", ..." : text;
}

void refuse_missing(const std::vector<ResultReader>& parts) {
  const std::uint32_t count = shard_of(parts.front()).count;
  std::vector<std::uint32_t> missing;
  auto part = parts.begin();
  for (std::uint32_t number = 1; number <= count; ++number) {
    if (part != parts.end() && shard_of(*part).number == number) {
      ++part;
    } else {
      missing.push_back(number);
    }
  }
  if (missing.empty()) return;
  throw InputError((missing.size() == 1 ? "part " : "parts ") + numbers_text(missing) + " of " +
                   std::to_string(count) + (missing.size() == 1 ? " is missing" : " are missing") +
                   "; " + parts.front().name() + " is " + part_text(parts.front()));
}

}  // namespace

PartSet::PartSet(const std::vector<std::filesystem::path>& files) {
  if (files.empty()) throw UsageError("no parts to merge");
  require_open_files(files.size(), "to merge " + std::to_string(files.size()) + " parts");
  for (const std::filesystem::path& file : files) {
    parts_.push_back(open_part(file));
    const std::string differs = difference_of(parts_.back(), parts_.front());
    if (!differs.empty()) refuse(parts_.back().name(), differs);
  }
  std::ranges::stable_sort(parts_, {},
                           [](const ResultReader& part) { return shard_of(part).number; });
  const auto twice = std::ranges::adjacent_find(
      parts_, {}, [](const ResultReader& part) { return shard_of(part).number; });
  if (twice != parts_.end()) {
    const std::string& name = (twice + 1)->name();
    const std::string once = "; give each part once";
    if (name == twice->name()) refuse(name, "is given twice" + once);
    refuse(name, "is " + part_text(*twice) + ", and so is " + twice->name() + once);
  }
  refuse_missing(parts_);
  header_ = parts_.front().header();
  header_.part.reset();
  for (const ResultReader& part : parts_) {
    double& metres = header_.model_spacing.metres;
    metres = std::max(metres, part.header().model_spacing.metres);
  }
  header_.last_pose =
      std::ranges::all_of(parts_, [](const ResultReader& part) { return part.header().last_pose; });
}

std::vector<PartWarning> PartSet::warnings() const {
  const auto is_same = [](const Message& a, const Message& b) {
    return a.code == b.code && a.text == b.text;
  };
  std::vector<PartWarning> all;
  for (const ResultReader& part : parts_) {
    std::vector<Message> told;  // warnings of this part, each once
    for (const Message& warning : part.header().part->warnings) {
      const auto same = [&](const Message& other) { return is_same(warning, other); };
      if (std::ranges::any_of(told, same)) continue;
      told.push_back(warning);
      auto known = std::ranges::find_if(all, same);
      if (known == all.end()) known = all.insert(all.end(), PartWarning{warning, 0});
      ++known->parts;
    }
  }
  return all;
}

std::uint64_t PartSet::collisions() const {
  std::uint64_t rows = 0;
  for (const ResultReader& part : parts_) rows += part.collisions();
  return rows;
}

std::uint64_t PartSet::clearances() const {
  std::uint64_t rows = 0;
  for (const ResultReader& part : parts_) rows += part.clearances();
  return rows;
}

ResultFindings PartSet::findings() const {
  std::vector<Message> warnings;
  for (const ResultReader& part : parts_) {
    const auto& told = part.header().part->warnings;
    warnings.insert(warnings.end(), told.begin(), told.end());
  }
  ResultFindings out{.doubts = doubts_among(warnings)};
  for (const ResultReader& part : parts_) {
    if (!out.searched) out.searched = part.findings().searched;
    if (out.without_bodies.empty()) out.without_bodies = part.findings().without_bodies;
  }
  if (!header_.ignores_points()) return out;
  const auto sum_of = [&](auto member) {
    std::optional<std::uint64_t> sum = 0;
    for (const ResultReader& part : parts_) {
      const std::optional<std::uint64_t>& of_part = part.findings().*member;
      if (!of_part) return std::optional<std::uint64_t>();
      *sum += *of_part;
    }
    return sum;
  };
  out.ignored_colliding = sum_of(&ResultFindings::ignored_colliding);
  out.ignored_colliding_high = sum_of(&ResultFindings::ignored_colliding_high);
  return out;
}

Answer PartSet::answer() const {
  Answer answer = answer_of(header_);
  add_findings(findings(), answer);
  answer.colliding_points = collisions();
  answer.clearance_points = clearances();
  return answer;
}

}  // namespace clearway
