#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "core/page_engine.hpp"

namespace clearway {

/// Several engines, each on its own device and with as many slots as the others, as one.
class EngineGroup final : public PageEngine {
 public:
  explicit EngineGroup(std::vector<std::unique_ptr<PageEngine>> engines)
      : engines_(std::move(engines)) {}

  const std::vector<std::unique_ptr<PageEngine>>& engines() const { return engines_; }

  std::uint32_t slots() const override { return count() * engines_.front()->slots(); }
  std::span<std::byte> page(std::uint32_t slot) override { return of(slot).page(slot / count()); }
  void start(std::uint32_t slot, const PageShape& shape) override {
    of(slot).start(slot / count(), shape);
  }
  PageAnswer finish(std::uint32_t slot) override { return of(slot).finish(slot / count()); }

 private:
  std::uint32_t count() const { return static_cast<std::uint32_t>(engines_.size()); }
  PageEngine& of(std::uint32_t slot) { return *engines_[slot % count()]; }

  std::vector<std::unique_ptr<PageEngine>> engines_;
};

}  // namespace clearway
