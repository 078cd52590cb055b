#pragma once

#include <optional>
#include <pugixml.hpp>
#include <string>
#include <vector>

#include "clearway/alignment.hpp"
#include "core/trajectory/alignment/alignment.hpp"
#include "io/paths/alignment/alignment_file.hpp"
#include "io/paths/alignment/land_xml.hpp"
#include "io/paths/poses_along.hpp"

/// The parts of an alignment in LandXML 1.2. All functions throw InputError, with the line, for
/// what is malformed, not read or does not fit together, and append warnings to `out`.
namespace clearway {

/// The plan of an element Alignment. max_gap: see AlignmentOptions.
AlignmentPlan read_plan(const LandXml& xml, pugi::xml_node alignment, double max_gap,
                        AlignmentFile& out);

/// The profile that the options name, or the only one; nullopt where the alignment has none. Sets
/// its name in `out`.
std::optional<AlignmentProfile> read_profile(const LandXml& xml, pugi::xml_node alignment,
                                             const AlignmentOptions& options, AlignmentFile& out);

/// Sets the cant of an alignment and how it turns the track; no cant where the file has none, where
/// it is 0 throughout, and where the options leave it out.
void read_cant(const LandXml& xml, pugi::xml_node alignment, const AlignmentOptions& options,
               Alignment& track, AlignmentFile& out);

/// The node of a name, or the only one if no name is wanted. noun: what the nodes are, for
/// messages. option: the one that names a node.
pugi::xml_node choose_by_name(const LandXml& xml, const std::vector<pugi::xml_node>& nodes,
                              const std::string& wanted, const std::string& noun,
                              const std::string& option);

/// Warns of parts of an alignment that the poses do not follow: station equations and the
/// superelevation of a road.
void remark_left_out(const LandXml& xml, pugi::xml_node alignment, AlignmentFile& out);

}  // namespace clearway
