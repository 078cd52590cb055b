#pragma once

namespace clearway::tool {

/// The whole program, as main calls it. A campaign calls it in processes that it forks.
int run_clearway(int argc, char** argv);

}  // namespace clearway::tool
