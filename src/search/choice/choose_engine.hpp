#pragma once

#include "clearway/query.hpp"
#include "clearway/search.hpp"
#include "core/util/message_log.hpp"
#include "io/store/store_reader.hpp"

namespace clearway {

/// Sets options.engine where it is kAuto, for a search on the CPU (on_gpu: on GPUs): to the engine
/// that will be faster by estimate, of those that can answer the query within the memory. The
/// report gets the estimates where they decided, and the log the reason. earlier: of the run that
/// is resumed, which goes on; kAuto for none. options.threads is not 0.
void choose_engine(const StoreReader& store, const Query& query, Engine earlier, bool on_gpu,
                   SearchOptions& options, SearchReport& report, const MessageLog& log);

}  // namespace clearway
