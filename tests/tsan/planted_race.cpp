// Work for the thread sanitizer, annotated as src/ is: without a race, or with a planted one, which
// has to be reported. Usage: planted_race KIND
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_pipeline.h>

#include <atomic>
#include <chrono>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "core/util/tsan_annotations.hpp"

using namespace clearway;

namespace {

constexpr std::size_t kItems = 200;

struct Item {
  std::size_t number = 0;
  std::vector<std::size_t> values{};
};

/// Waits long enough for another thread to take part.
void pause() { std::this_thread::sleep_for(std::chrono::microseconds(200)); }

class Pipeline {
 public:
  explicit Pipeline(std::string planted) : planted_(std::move(planted)) {}

  std::size_t run() {
    const ParallelScope scope;
    const SerialStage input, output;
    using Batch = std::shared_ptr<Item>;
    const auto next = piece_of(scope, input, [&](tbb::flow_control& flow) {
      pause();
      if (next_ == kItems) flow.stop();
      latest_ = next_;
      return std::make_shared<Item>(Item{next_++});
    });
    const auto fill = piece_of(scope, [&](const Batch& item) {
      pause();
      if (planted_ == "counter") ++filled_;
      if (planted_ == "other stage") item->values.push_back(latest_);
      if (planted_ == "exception" && item->number == kItems / 2) throw std::runtime_error("half");
      item->values.assign(50, item->number);
      if (planted_ == "kept") kept_ = item;
      return item;
    });
    const auto sum = piece_of(scope, output, [&](const Batch& item) {
      pause();
      if (planted_ == "input") ++next_;
      for (const std::size_t value : item->values) sum_ += value;
    });
    constexpr auto serial = tbb::filter_mode::serial_in_order;
    scope.begin();
    tbb::parallel_pipeline(
        8, tbb::make_filter<void, Handed<Batch>>(serial, next) &
               tbb::make_filter<Handed<Batch>, Handed<Batch>>(tbb::filter_mode::parallel, fill) &
               tbb::make_filter<Handed<Batch>, void>(serial, sum));
    return sum_;
  }

  std::size_t seen() const { return sum_ + next_; }

 private:
  std::string planted_;
  std::size_t next_ = 0, latest_ = 0, filled_ = 0, sum_ = 0;
  std::shared_ptr<Item> kept_;
};

std::size_t loop(const std::string& planted) {
  std::vector<std::size_t> values(kItems);
  std::size_t sum = 0;
  {
    const ParallelScope scope;
    const auto body = piece_of(scope, [&](std::size_t i) {
      pause();
      values[i] = i;
      if (planted == "loop") sum += i;
    });
    scope.begin();
    tbb::parallel_for(std::size_t{0}, kItems, body);
  }
  for (const std::size_t value : values) sum += value;
  return sum;
}

std::size_t halves(const std::string& planted) {
  std::size_t left = 0, right = 0, both = 0;
  for (int i = 0; i < 50; ++i) {
    const ParallelScope scope;
    const auto half = [&](std::size_t& own) {
      pause();
      ++own;
      if (planted == "halves") ++both;
    };
    const auto first = piece_of(scope, [&] { half(left); });
    const auto second = piece_of(scope, [&] { half(right); });
    scope.begin();
    tbb::parallel_invoke(first, second);
  }
  return left + right + both;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string planted = argc > 1 ? argv[1] : "none";
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, 4);
  Pipeline pipeline(planted);
  std::size_t sum = 0;
  try {
    sum = pipeline.run();
  } catch (const std::runtime_error& error) {
    sum = pipeline.seen() + std::string(error.what()).size();
  }
  std::cout << planted << ": " << sum + loop(planted) + halves(planted) << "\n";
}
