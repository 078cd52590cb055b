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

/// Around what oneTBB runs, a stage of a pipeline or the body of a loop: tells the thread
/// sanitizer, which does not see into oneTBB, that it begins after those that have ended. Nothing
/// in other builds. work: the same address in all of them and, before and after them, in the
/// caller.
class HandOver {
 public:
#ifdef CLEARWAY_THREAD_SANITIZER
  explicit HandOver(const void* work) : work_(const_cast<void*>(work)) { __tsan_acquire(work_); }
  ~HandOver() { __tsan_release(work_); }

 private:
  void* work_;
#else
  explicit HandOver(const void*) {}
  ~HandOver() {}
#endif

 public:
  HandOver(const HandOver&) = delete;
  HandOver& operator=(const HandOver&) = delete;
};

}  // namespace clearway
