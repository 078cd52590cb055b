#include "search/kept_models.hpp"

#include <algorithm>

#include "core/geometry/triangle_box.hpp"
#include "io/paths/content_hash.hpp"

namespace clearway {
namespace {

constexpr std::size_t kFieldsOfSession = 4;

std::span<const Vec3> points_of(const Model& model) {
  return model.is_surface() ? std::span<const Vec3>() : std::span<const Vec3>(model.vertices);
}

}  // namespace

ModelIndex::ModelIndex(const Model& model, int threads, std::size_t most_fields)
    : points(points_of(model), threads),
      triangles(triangles_of(model), threads),
      solids(model, threads),
      most_fields_(most_fields) {}

template <typename Element>
std::shared_ptr<const ModelField> ModelIndex::field(double radius, ModelFieldOptions options,
                                                    int threads) {
  options.solids = solids_of<Element>();
  if (auto kept = kept_field(radius, options)) return kept;
  // Only those who need a further field of this model wait while one is made.
  const std::lock_guard making(making_);
  if (auto kept = kept_field(radius, options)) return kept;  // another thread made it meanwhile
  {
    const std::lock_guard lock(mutex_);
    while (fields_.size() >= most_fields_) fields_.pop_back();
  }
  auto made = std::make_shared<const ModelField>(of<Element>(), radius, options, threads);
  const std::lock_guard lock(mutex_);
  fields_.push_front({radius, options, made});
  return made;
}

std::shared_ptr<const ModelField> ModelIndex::kept_field(double radius,
                                                         const ModelFieldOptions& options) {
  const std::lock_guard lock(mutex_);
  const auto kept = std::ranges::find_if(fields_, [&](const KeptField& one) {
    return one.radius == radius && one.options == options;
  });
  if (kept == fields_.end()) return nullptr;
  fields_.splice(fields_.begin(), fields_, kept);
  return kept->field;
}

template std::shared_ptr<const ModelField> ModelIndex::field<Vec3>(double, ModelFieldOptions, int);
template std::shared_ptr<const ModelField> ModelIndex::field<Triangle>(double, ModelFieldOptions,
                                                                       int);
template std::shared_ptr<const ModelField> ModelIndex::field<SolidTriangle>(double,
                                                                            ModelFieldOptions, int);

std::uint64_t ModelIndex::allocated_bytes() const {
  std::uint64_t bytes =
      points.allocated_bytes() + triangles.allocated_bytes() + solids.allocated_bytes();
  const std::lock_guard lock(mutex_);
  for (const KeptField& one : fields_) bytes += one.field->allocated_bytes();
  return bytes;
}

std::shared_ptr<ModelIndex> KeptModels::index_of(const Model& model,
                                                 std::optional<std::uint64_t> known_hash,
                                                 int threads) {
  const std::uint64_t hash = known_hash ? *known_hash : hash_of_model(model);
  const auto is_same = [&](const KeptModel& one) {
    return one.hash == hash && one.vertices == model.vertices.size() &&
           one.triangles == model.triangles.size();
  };
  const auto take = [&]() -> std::shared_ptr<ModelIndex> {
    const auto kept = std::ranges::find_if(models_, is_same);
    if (kept == models_.end()) return nullptr;
    models_.splice(models_.begin(), models_, kept);
    forget_beyond_limit();
    return kept->index;
  };
  {
    const std::lock_guard lock(mutex_);
    if (auto kept = take()) return kept;
  }
  // Made without the lock, so that questions about other models go on.
  auto made = std::make_shared<ModelIndex>(model, threads, is_session() ? kFieldsOfSession : 1);
  const std::lock_guard lock(mutex_);
  if (auto kept = take()) return kept;  // another thread was faster
  models_.push_front({hash, model.vertices.size(), model.triangles.size(), made});
  forget_beyond_limit();
  return made;
}

void KeptModels::forget_beyond_limit() {
  std::uint64_t bytes = 0;
  for (auto model = models_.begin(); model != models_.end();) {
    bytes += model->index->allocated_bytes();
    const bool keeps = model == models_.begin() || bytes <= most_bytes_;
    model = keeps ? std::next(model) : models_.erase(model);
  }
}

void KeptModels::forget_all() {
  const std::lock_guard lock(mutex_);
  models_.clear();
}

std::uint64_t KeptModels::allocated_bytes() const {
  const std::lock_guard lock(mutex_);
  std::uint64_t bytes = 0;
  for (const KeptModel& model : models_) bytes += model.index->allocated_bytes();
  return bytes;
}

}  // namespace clearway
