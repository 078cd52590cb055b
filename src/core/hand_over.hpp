#pragma once

#if defined(__SANITIZE_THREAD__)
#define CLEARWAY_THREAD_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define CLEARWAY_THREAD_SANITIZER 1
#endif
#endif

#ifdef CLEARWAY_THREAD_SANITIZER
extern "C" {
void __tsan_acquire(void* address);
void __tsan_release(void* address);
}
#endif

namespace clearway {

/// Around what a stage of a oneTBB pipeline does: tells the thread sanitizer, which does not see
/// into oneTBB, that a stage begins after those that have ended. Nothing in other builds.
/// pipeline: the same address in all stages and in the caller.
class HandOver {
 public:
#ifdef CLEARWAY_THREAD_SANITIZER
  explicit HandOver(const void* pipeline) : pipeline_(const_cast<void*>(pipeline)) {
    __tsan_acquire(pipeline_);
  }
  ~HandOver() { __tsan_release(pipeline_); }

 private:
  void* pipeline_;
#else
  explicit HandOver(const void*) {}
  ~HandOver() {}
#endif

 public:
  HandOver(const HandOver&) = delete;
  HandOver& operator=(const HandOver&) = delete;
};

}  // namespace clearway
