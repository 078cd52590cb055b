#include <catch2/catch.hpp>
#include <cstddef>
#include <tuple>
#include <type_traits>

#include "core/describe/answer.hpp"
#include "core/describe/reports.hpp"
#include "core/describe/section_report.hpp"

using namespace clearway;

namespace {

/// What a member or a base of a struct can be made of.
template <typename Struct>
struct AnyMember {
  template <typename Member>
  requires(!std::is_same_v<Member, Struct>) operator Member() const;
};

/// How many initializers a struct takes: one for each member, and one for its base.
template <typename Struct, typename... Members>
consteval std::size_t members_of(Members... members) {
  if constexpr (requires { Struct{members..., AnyMember<Struct>()}; }) {
    return members_of<Struct>(members..., AnyMember<Struct>());
  } else {
    return sizeof...(members);
  }
}

template <typename Report>
consteval std::size_t undescribed() {
  const std::size_t described = std::apply(
      [](const auto&... fact) {
        return (std::size_t{std::is_member_object_pointer_v<decltype(fact.member)>} + ...);
      },
      kFactsOf<Report>);
  return members_of<Report>() - described;
}

template <typename... Reports>
constexpr bool kAreDescribed = ((undescribed<Reports>() == 0) && ...);

}  // namespace

TEST_CASE("no member of a report is described nowhere") {
  STATIC_REQUIRE(
      kAreDescribed<SearchSeconds, BytesRead, DeviceEstimate, OriginsPathReport, SectionReport,
                    StationTable, ShiftTable, Ledger, IgnoredPointCounts, SearchedLength,
                    OutlineGap, SectionGrid, SectionSeenCounts, SectionIgnoredCells,
                    UnsearchedStretch, OutsideOfAccepted, Overthrow>);
  STATIC_REQUIRE(undescribed<SearchReport>() == 1);     // its base, Answer
  STATIC_REQUIRE(undescribed<MergeReport>() == 1);      // likewise
  STATIC_REQUIRE(undescribed<ConvertReport>() == 1);    // busy_seconds, of the command line's JSON
  STATIC_REQUIRE(undescribed<FoundPlace>() == 1);       // body, whose name Python shows
  STATIC_REQUIRE(undescribed<Conflicts>() == 3);        // knows_shifts, knows_trims, near_points
  STATIC_REQUIRE(undescribed<SmoothPath>() == 1);       // labels
  STATIC_REQUIRE(undescribed<ReportSummary>() == 1);    // conflicts
  STATIC_REQUIRE(undescribed<SectionStop>() == 2);      // intrusions, row
  STATIC_REQUIRE(undescribed<SectionCheck>() == 1);     // reason, which Python shows as None
  STATIC_REQUIRE(undescribed<OutlineRowCheck>() == 1);  // file, which Python shows as a text
}
