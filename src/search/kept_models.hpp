#pragma once

#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "clearway/model.hpp"
#include "core/geometry/model_tree.hpp"
#include "core/geometry/solid_parts.hpp"
#include "core/sweep/field/model_field.hpp"

namespace clearway {

/// What a search looks up of a model: the trees over its points or triangles, and the fields that
/// were made from them. It does not refer to the model. Thread safe.
class ModelIndex {
 public:
  /// most_fields: how many fields are kept, at least 1.
  ModelIndex(const Model& model, int threads, std::size_t most_fields);

  /// The model's box. The model is not empty.
  const Box& box() const { return triangles.size() > 0 ? triangles.box() : points.box(); }

  /// The tree over the model's elements.
  template <typename Element>
  const ModelTreeOf<StoredElement<Element>>& of() const {
    if constexpr (kIsTriangle<Element>) {
      return triangles;
    } else {
      return points;
    }
  }

  /// The model's solids, for a field of these elements; null where the elements are not of solids.
  template <typename Element>
  const SolidParts* solids_of() const {
    return kIsSolid<Element> ? &solids : nullptr;
  }

  /// The field with this radius and these options, which is made unless it is kept, one field at a
  /// time. The least recently used field is forgotten before a new one would be one too many. The
  /// index outlives the field. options.solids is set here.
  template <typename Element>
  std::shared_ptr<const ModelField> field(double radius, ModelFieldOptions options, int threads);

  /// Bytes of the trees, and of the fields that are kept.
  std::uint64_t allocated_bytes() const;

  const ModelTree points;        ///< empty for a surface
  const TriangleTree triangles;  ///< empty for a model of points
  const SolidParts solids;       ///< empty where the surface has no solids

 private:
  struct KeptField {
    double radius;
    ModelFieldOptions options;
    std::shared_ptr<const ModelField> field;
  };

  /// The field, if it is kept, which is then the most recently used one.
  std::shared_ptr<const ModelField> kept_field(double radius, const ModelFieldOptions& options);

  const std::size_t most_fields_;
  std::mutex making_;            ///< held while a field is made; taken before `mutex_`
  mutable std::mutex mutex_;     ///< of the list, and never held for long
  std::list<KeptField> fields_;  ///< the most recently used one first
};

/// The indexes of the models that were searched, so that further questions about them need not make
/// them again. Thread safe.
class KeptModels {
 public:
  /// How much is kept.
  enum class Kept {
    kOneField,   ///< one field of each model, as one search with its further searches needs
    kForSession  ///< several fields of each model, for questions to come
  };

  /// most_bytes: models beyond them are forgotten, the least recently used one first, but not the
  /// one that was asked for last.
  KeptModels(Kept kept, std::uint64_t most_bytes) : kept_(kept), most_bytes_(most_bytes) {}

  /// The index of a model, which is made unless it is kept. hash: hash_of_model(), where it is
  /// known.
  std::shared_ptr<ModelIndex> index_of(const Model& model, std::optional<std::uint64_t> hash,
                                       int threads);

  bool is_session() const { return kept_ == Kept::kForSession; }
  void forget_all();
  std::uint64_t allocated_bytes() const;

 private:
  struct KeptModel {
    std::uint64_t hash;
    std::size_t vertices, triangles;
    std::shared_ptr<ModelIndex> index;
  };

  void forget_beyond_limit();

  const Kept kept_;
  const std::uint64_t most_bytes_;
  mutable std::mutex mutex_;
  std::list<KeptModel> models_;  ///< the most recently used one first
};

}  // namespace clearway
