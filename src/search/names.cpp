#include <algorithm>

#include "core/describe/machine.hpp"
#include "core/describe/search.hpp"

namespace clearway {
namespace {

template <typename Enum>
const char* name_in_choices(Enum value) {
  return std::ranges::find(kChoices<Enum>, value, &Choice<Enum>::value)->name;
}

}  // namespace

const char* name_of(Engine engine) { return name_in_choices(engine); }

const char* name_of(Device device) { return name_in_choices(device); }

}  // namespace clearway
