#pragma once

#include <string>

namespace clearway {

/// Of a file's coordinates.
enum class LengthUnit { kUnknown, kMetre, kFoot, kUsSurveyFoot, kDegrees };

/// "unknown", "metre", "foot", "us-survey-foot", "degree".
std::string to_string(LengthUnit unit);
/// kUnknown for any other text.
LengthUnit length_unit_of(const std::string& name);
/// "m", "ft", "US ft", "deg"; metres where it is not known.
const char* symbol_of(LengthUnit unit);
/// 0 for those that are no lengths of a known size.
double metres_of(LengthUnit unit);

}  // namespace clearway
