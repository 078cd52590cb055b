#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "clearway/ignored.hpp"
#include "clearway/progress.hpp"
#include "clearway/query.hpp"
#include "clearway/section.hpp"
#include "core/messages/messages.hpp"
#include "io/store/store_reader.hpp"
#include "search/checks/facts/model_looks.hpp"

namespace clearway {

/// What the checks found about one body of a vehicle.
struct BodyMessages {
  std::string name;
  std::vector<Message> messages;
};

/// Adds what was found to the log, with the names of the bodies, and once where several have it in
/// common. A warning that the ground, or what is beside the path, is missing is given for the
/// vehicle where it holds for all of its bodies that the scan covers; otherwise it is not given.
/// One about the ground on a stretch of the path is given where it holds for any body. Of warnings
/// about stretches that of the body with the longest one is given, with the stretches of all.
void warn_of_bodies_once(const std::vector<BodyMessages>& bodies, MessageLog& log);

/// Warns where a query may answer something other than was meant, because of a path in another
/// frame, a model in another unit, steps that skip things, or what it ignores. Reads the store's
/// index, and the points below a few poses. The model is not empty. Deterministic. ignored:
/// count_ignored() of the query. of_inputs: messages of reading the inputs, such as which poses a
/// body lacks; what they say is not said again.
void warn_of_query(const StoreReader& store, const Query& query, const IgnoredPointCounts& ignored,
                   std::span<const Message> of_inputs, MessageLog& log);

/// Gives what is known of a model for the radius of the query.
using LooksOf = std::function<std::shared_ptr<const ModelLooks>(const Model&)>;

/// Warns as above, for models that may have been looked at before: looks_of gives what is known.
void warn_of_query(const StoreReader& store, const Query& query, const IgnoredPointCounts& ignored,
                   const LooksOf& looks_of, std::span<const Message> of_inputs, MessageLog& log);

/// Warns as above for the load of a section, of which the range is known and the outline is not:
/// the checks are those of its path, its place and the scan. asked: with the defaults filled in.
/// load: load_of_section(). chainage: of all poses of the path.
void warn_of_section(const StoreReader& store, const SectionParameters& asked,
                     const IgnoredPointCounts& ignored, const Body& load,
                     std::span<const double> chainage, std::span<const Message> of_inputs,
                     MessageLog& log);

}  // namespace clearway
