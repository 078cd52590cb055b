#include "io/result/conflicts/bcf/bcf_text.hpp"

#include <array>
#include <cmath>

#include "core/util/format.hpp"
#include "io/files/json.hpp"
#include "io/files/xxh64.hpp"
#include "io/result/conflicts/conflict_fields.hpp"
#include "io/result/conflicts/conflict_words.hpp"
#include "io/result/conflicts/markup_text.hpp"
#include "io/scans/length_unit.hpp"

namespace clearway {
namespace {

constexpr const char* kDeclaration = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";

std::uint64_t hash_of(std::string_view text) {
  return xxh64(std::as_bytes(std::span(text.data(), text.size())));
}

std::string element(std::string_view name, const std::string& content) {
  return "<" + std::string(name) + ">" + content + "</" + std::string(name) + ">";
}

std::string vector_element(std::string_view name, const Vec3& v) {
  return element(name, element("X", json_number(v.x)) + element("Y", json_number(v.y)) +
                           element("Z", json_number(v.z)));
}

/// A place of the environment in metres, the unit of BCF.
Vec3 in_metres(const ConflictFile& file, const Vec3& v) {
  const double metres = file.metres_per_unit();
  return {v.x * metres, v.y * metres, v.z * metres};
}

/// The lines of a viewpoint for the twelve edges of a box.
std::string edges_of(const Box& box) {
  std::string out;
  for (unsigned from = 0; from < 8; ++from) {
    for (const unsigned axis : {1U, 2U, 4U}) {
      if ((from & axis) != 0) continue;
      out += "    " +
             element("Line", vector_element("StartPoint", box.corner(from)) +
                                 vector_element("EndPoint", box.corner(from | axis))) +
             "\n";
    }
  }
  return out;
}

std::string length_text(const ConflictFile& file, const std::string& number) {
  return number + " " + symbol_of(file.unit());
}

/// The stations of a conflict to a centimetre, which are metres: "1250 m", or "1250 to 1262.5 m" in
/// either direction.
std::string station_text(const Conflict& c) {
  const auto text = [](double metres) { return format_number(std::round(metres * 100) / 100); };
  std::string out = text(*c.station_from);
  if (c.station_to && *c.station_to != *c.station_from) out += " to " + text(*c.station_to);
  return out + " m";
}

std::string title_of(const ConflictFile& file, const Conflict& c) {
  const std::string what =
      c.id > 0 ? "Conflict " + std::to_string(c.id) : "Group of " + counted(c.points, "point");
  std::string out = what + " at " + length_text(file, format_brief(c.chainage_from));
  if (c.chainage_to > c.chainage_from) {
    out += " to " + length_text(file, format_brief(c.chainage_to));
  }
  if (c.station_from) out += ", station " + station_text(c);
  if (c.side != Side::kUnknown) out += std::string(", ") + name_of(c.side);
  return out;
}

/// The origin of offsets in words: "the path's position", or that of the body from which the
/// conflict is seen.
std::string origin_text(const ConflictFile& file, const Conflict& c) {
  if (!c.body || file.options.bodies.empty()) return "the path's position";
  return "the position of " + markup_text(body_words(file.header.bodies.at(*c.body)));
}

/// The offset of a conflict in words: "1.25 m left of the path's position and 0.5 m above it".
std::string offset_text(const ConflictFile& file, const Conflict& c) {
  return length_text(file, format_brief(std::abs(*c.lateral))) +
         (*c.lateral < 0 ? " right of " : " left of ") + origin_text(file, c) + " and " +
         length_text(file, format_brief(std::abs(*c.height))) +
         (*c.height < 0 ? " below it" : " above it");
}

/// A sentence on small groups, which have no topic in the archive.
std::string small_text(const ConflictFile& file) {
  const Conflicts& found = file.conflicts;
  if (found.small_groups == 0) return "";
  return " In all, " + counted(found.small_groups, "group") + " of fewer than " +
         counted(file.conflicts.min_points, "point") +
         (found.small_groups == 1 ? " collides" : " collide") + " too, with " +
         counted(found.small_points, "point") + " together.";
}

/// What is missing: "; 0.100 m are missing", "; at least 0.100 m are missing" or "; it touches the
/// model". Empty where the points are only near.
std::string missing_text(const ConflictFile& file, const Conflict& c) {
  const std::string words = missing_words(c, symbol_of(file.unit()), file.metres_per_unit());
  if (words.empty()) return "";
  return words == "touches" ? "; it touches the model" : "; " + words + " are missing";
}

/// What frees the vehicle from the conflict, in sentences; empty where nothing is known.
std::string remedy_text(const ConflictFile& file, const Conflict& c) {
  const std::string words = remedy_words(c, words_about(c, file));
  return words.empty() ? "" : " " + markup_text(words);
}

/// What the ledger says of a conflict: " By the ledger it is worse, because the radius is larger;
/// row 2: slow here."
std::string ledger_text(const LedgerEntry& entry) {
  std::string out = std::string(" By the ledger it is ") + name_of(entry.status);
  if (!entry.why.empty()) out += ", because " + markup_text(entry.why);
  if (!entry.key.empty()) out += "; row " + markup_text(entry.key);
  if (!entry.until.empty()) out += ", until " + markup_text(entry.until);
  if (!entry.comment.empty()) out += ": " + markup_text(entry.comment);
  return out + ".";
}

std::string description_of(const ConflictFile& file, const Conflict& c) {
  const std::uint64_t near = c.points - c.colliding;
  std::string out = format_count(c.colliding) + (c.colliding == 1 ? " point is" : " points are") +
                    " closer than " + length_text(file, format_length(file.header.radius)) +
                    " to the moving model" +
                    (near > 0 ? ", and " + counted(near, "point") + " may be by the errors." : ".");
  if (const std::string classes = class_words(c); !classes.empty())
    out += " Of these, " + classes + ".";
  if (c.least_distance && *c.least_distance < 0) {
    out += " The deepest point is " + length_text(file, format_brief(-*c.least_distance)) +
           " inside the model, at pose " + std::to_string(*c.nearest_pose) + "; " +
           format_count(*c.points_inside) +
           (*c.points_inside == 1 ? " point is inside." : " points are inside.");
  } else if (c.least_distance) {
    out += " The least distance is " + length_text(file, format_brief(*c.least_distance)) +
           ", at pose " + std::to_string(*c.nearest_pose) + missing_text(file, c) + ".";
  }
  if (c.lateral && c.height) {
    out += std::string(!c.nearest_point                  ? " The point that is touched first"
                       : c.points_inside.value_or(0) > 0 ? " That point"
                                                         : " Its nearest point") +
           " lies " + offset_text(file, c) + ".";
  }
  if (c.obstacle_chainage) {
    out += " The obstacle stands at chainage " +
           length_text(file, format_brief(*c.obstacle_chainage)) + ".";
  }
  out += remedy_text(file, c);
  out += " Poses " + std::to_string(c.first_pose) + " to " + std::to_string(c.last_pose) +
         ", counted from 0, touch it.";
  if (const LedgerEntry* const entry = ledger_entry_of(c, file)) out += ledger_text(*entry);
  return out + small_text(file);
}

}  // namespace

std::string uuid_of(std::string_view text) {
  std::string digits = hash_text(hash_of(text)) + hash_text(hash_of("2 " + std::string(text)));
  digits[12] = '8';                                               // version
  digits[16] = "89ab"[static_cast<std::size_t>(digits[16]) % 4];  // variant
  for (const std::size_t at : {20, 16, 12, 8}) digits.insert(at, 1, '-');
  return digits;
}

std::string conflict_uuid(const ConflictFile& file, const Conflict& conflict,
                          std::string_view what) {
  const ResultHeader& header = file.header;
  std::string text = "clearway " + std::string(what);
  for (const std::uint64_t hash :
       {header.environment_hash, header.model_hash, header.trajectory_hash}) {
    text += " " + hash_text(hash);
  }
  for (const double length : {header.radius, file.conflicts.gap, file.options.split}) {
    text += " " + json_number(length);
  }
  return uuid_of(text + (header.between_poses ? " between " : " at ") +
                 std::to_string(conflict.source));
}

std::string bcf_version() {
  return std::string(kDeclaration) +
         "<Version VersionId=\"2.1\">\n  <DetailedVersion>2.1</DetailedVersion>\n</Version>\n";
}

std::string bcf_markup(const ConflictFile& file, const Conflict& conflict) {
  const LedgerEntry* const entry = ledger_entry_of(conflict, file);
  const bool is_accepted = entry != nullptr && entry->status == LedgerStatus::kAccepted;
  std::string out = kDeclaration;
  out += "<Markup>\n  <Topic Guid=\"" + conflict_uuid(file, conflict, "topic") +
         "\" TopicType=\"Clash\" TopicStatus=\"" + (is_accepted ? "Closed" : "Open") + "\">\n";
  const auto line = [&out](std::string_view name, const std::string& content) {
    out += "    " + element(name, content) + "\n";
  };
  line("Title", title_of(file, conflict));
  line("Index", std::to_string(conflict.id));
  if (entry != nullptr) line("Labels", name_of(entry->status));
  line("CreationDate", file.date);
  line("CreationAuthor", "Clearway");
  if (entry != nullptr && !entry->owner.empty()) line("AssignedTo", markup_text(entry->owner));
  line("Description", description_of(file, conflict));
  out += "  </Topic>\n  <Viewpoints Guid=\"" + conflict_uuid(file, conflict, "viewpoint") + "\">\n";
  line("Viewpoint", "viewpoint.bcfv");
  line("Snapshot", "snapshot.png");
  return out + "  </Viewpoints>\n</Markup>\n";
}

std::string bcf_viewpoint(const ConflictFile& file, const Conflict& conflict,
                          const Camera& camera) {
  std::string out = kDeclaration;
  out += "<VisualizationInfo Guid=\"" + conflict_uuid(file, conflict, "viewpoint") + "\">\n";
  out += "  <PerspectiveCamera>\n";
  out += "    " + vector_element("CameraViewPoint", in_metres(file, camera.place)) + "\n";
  out += "    " + vector_element("CameraDirection", camera.direction) + "\n";
  out += "    " + vector_element("CameraUpVector", camera.up) + "\n";
  out += "    " + element("FieldOfView", json_number(camera.field_of_view)) + "\n";
  out += "  </PerspectiveCamera>\n  <Lines>\n" +
         edges_of({in_metres(file, conflict.box.lo), in_metres(file, conflict.box.hi)}) +
         "  </Lines>\n";
  return out + "</VisualizationInfo>\n";
}

}  // namespace clearway
