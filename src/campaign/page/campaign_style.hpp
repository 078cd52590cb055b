#pragma once

namespace clearway::campaign {

/// The style sheet of a campaign's page.
extern const char* const kCampaignStyle;

}  // namespace clearway::campaign
