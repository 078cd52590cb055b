#pragma once

#include <utility>

#if defined(__SANITIZE_THREAD__)
#define CLEARWAY_THREAD_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define CLEARWAY_THREAD_SANITIZER 1
#endif
#endif

// Tells the thread sanitizer, which does not see into oneTBB, what oneTBB guarantees about the work
// that it runs. Does nothing in other builds. docs/design/testing.md says how it was tried.

#ifdef CLEARWAY_THREAD_SANITIZER
extern "C" {
void __tsan_acquire(void* address);
void __tsan_release(void* address);
}
#endif

namespace clearway {

/// Whatever happened before the release of an address happens before what follows its acquisition.
#ifdef CLEARWAY_THREAD_SANITIZER
inline void acquire(const void* address) { __tsan_acquire(const_cast<void*>(address)); }
inline void release(const void* address) { __tsan_release(const_cast<void*>(address)); }
#else
inline void acquire(const void*) {}
inline void release(const void*) {}
#endif

/// The scope of one parallel call of oneTBB, in the caller. Every piece of work begins after the
/// caller's begin(), and has ended, possibly by an exception, before the caller leaves the scope.
class ParallelScope {
 public:
  ParallelScope() = default;
  ~ParallelScope() { end(); }
  /// To be called right before the parallel call, when its arguments are complete.
  void begin() const { release(&begun_); }
  /// To be called after the parallel call where its results are read within the scope.
  void end() const { acquire(&ended_); }
  ParallelScope(const ParallelScope&) = delete;
  ParallelScope& operator=(const ParallelScope&) = delete;

 private:
  template <typename Body>
  friend class PieceOfWork;
  char begun_ = 0, ended_ = 0;
};

/// A stage of a pipeline whose calls follow one another; it must outlive them.
struct SerialStage {
  char turn = 0;
};

#ifdef CLEARWAY_THREAD_SANITIZER
template <typename Body>
class PieceOfWork {
 public:
  PieceOfWork(const ParallelScope& scope, const SerialStage* stage, Body body)
      : scope_(&scope), stage_(stage), body_(std::move(body)) {}

  /// Not instrumented itself, because it must be read before it can be known to be written.
  template <typename... Arguments>
  __attribute__((no_sanitize("thread"))) auto operator()(Arguments&&... arguments) const {
    const Turn turn(scope_, stage_);
    return body_(std::forward<Arguments>(arguments)...);
  }

 private:
  struct Turn {
    Turn(const ParallelScope* of, const SerialStage* in) : scope(of), stage(in) {
      acquire(&scope->begun_);
      if (stage != nullptr) acquire(&stage->turn);
    }
    ~Turn() {
      if (stage != nullptr) release(&stage->turn);
      release(&scope->ended_);
    }
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;
    const ParallelScope* scope;
    const SerialStage* stage;
  };

  const ParallelScope* scope_;
  const SerialStage* stage_;
  Body body_;
};

/// Makes the body of a loop, or of a stage of a pipeline, part of the scope.
template <typename Body>
PieceOfWork<Body> piece_of(const ParallelScope& scope, Body body) {
  return {scope, nullptr, std::move(body)};
}
/// Makes the body of a stage whose calls follow one another part of the scope.
template <typename Body>
PieceOfWork<Body> piece_of(const ParallelScope& scope, const SerialStage& stage, Body body) {
  return {scope, &stage, std::move(body)};
}
#else
template <typename Body>
Body piece_of(const ParallelScope&, Body body) {
  return body;
}
template <typename Body>
Body piece_of(const ParallelScope&, const SerialStage&, Body body) {
  return body;
}
#endif

/// A value that a stage of a pipeline passes to the next, which begins after it was passed.
#ifdef CLEARWAY_THREAD_SANITIZER
template <typename Value>
class Handed {
 public:
  Handed(Value value) : value_(std::move(value)) { release(this); }
  Handed(Handed&& other) noexcept : value_((acquire(&other), std::move(other.value_))) {
    release(this);
  }
  ~Handed() { acquire(this); }
  operator const Value&() const {
    acquire(this);
    return value_;
  }

 private:
  Value value_;
};
#else
template <typename Value>
using Handed = Value;
#endif

}  // namespace clearway
