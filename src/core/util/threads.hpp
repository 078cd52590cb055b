#pragma once

#include <future>

namespace clearway {

/// How std::async() begins work beside the calling thread: on a thread of its own, or, where the
/// system gives none, in the thread that waits for it.
inline constexpr std::launch kBeside = std::launch::async | std::launch::deferred;

/// Starts for a moment as many threads as pools of this size of oneTBB and of OpenMP need together.
/// Throws ResourceError where the system does not give them; does nothing for a number that this
/// process has started before. OpenMP would end the process instead, and oneTBB may do so.
void check_threads(int threads);

/// Throws the ResourceError of check_threads(). threads: how many were needed. reason: the
/// system's words.
[[noreturn]] void refuse_threads(int threads, const char* reason);

}  // namespace clearway
