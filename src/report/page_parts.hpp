#pragma once

#include <string_view>

namespace clearway {

/// What the browser runs, of the files of src/report/page, which the build puts into the program.
/// A name in double braces stands for a part of the content.
extern const std::string_view kReportPage, kSectionPage, kComparisonPage, kCampaignPage;

}  // namespace clearway
