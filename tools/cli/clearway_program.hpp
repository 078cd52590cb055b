#pragma once

namespace clearway::tool {

/// The whole program, as main calls it. A campaign also calls it in the processes that it forks.
int run_clearway(int argc, char** argv);

}  // namespace clearway::tool
