#pragma once

#include "clearway/engines.hpp"

namespace clearway::tool {

/// run_engine for engine kdtree; options.threads is not 0.
Answer run_kdtree_engine(const Store& store, const Question& question, const EngineOptions& options,
                         AnswerJournal& journal, Progress& progress, EngineReport& report);

}  // namespace clearway::tool
