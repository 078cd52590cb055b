#pragma once

namespace clearway {

/// Throws ResourceError where this process may not have that many threads. OpenMP would end the
/// program instead.
void check_threads(int threads);

}  // namespace clearway
