#pragma once

#include "clearway/query.hpp"
#include "clearway/search.hpp"
#include "core/util/message_log.hpp"
#include "io/store/store_reader.hpp"

namespace clearway {

/// Where options.engine is kAuto, sets it to the engine that will be faster by estimate, of those
/// that can answer the query within the memory. on_gpu: the search is on GPUs, which takes the
/// sweep. earlier: the engine of the run that is resumed, which goes on with it; kAuto for none.
/// Where the estimates decided, the report gets them and the log the reason. options.threads is not
/// 0.
void choose_engine(const StoreReader& store, const Query& query, Engine earlier, bool on_gpu,
                   SearchOptions& options, SearchReport& report, const MessageLog& log);

}  // namespace clearway
