#include <utility>

#include "io/convert/inputs/for_each_batch.hpp"

namespace clearway {

bool EnvironmentPass::next(PassingBatch& batch) {
  if (failed_) return false;
  try {
    throw_if_stopped(progress_);
    const auto running = clocks_.measure(Stage::kRead);
    return environment_.next(batch.records);
  } catch (...) {
    batch.error = std::current_exception();
    failed_ = true;
  }
  return true;
}

void EnvironmentPass::read(PassingBatch& batch) const {
  const auto running = clocks_.measure(Stage::kRead);
  environment_.convert(batch.records, batch.quanta, files_ != nullptr);
}

void EnvironmentPass::hash_file(PassingBatch& batch) const {
  if (files_ == nullptr || batch.error) return;
  const auto running = clocks_.measure(Stage::kHash);
  const PieceBytes bytes = std::exchange(batch.quanta.bytes, {});
  if (bytes.count > 0) files_->add(batch.quanta.file, bytes);
}

void EnvironmentPass::note(const PassingBatch& batch) const {
  if (batch.error) std::rethrow_exception(batch.error);
  environment_.note(batch.quanta);
}

}  // namespace clearway
