#pragma once

#include <cstring>
#include <string>

namespace clearway::test {

/// A record of an SBET, in radians, metres and seconds.
struct SbetRecord {
  double time = 151631, latitude = 0.9, longitude = 0.15, altitude = 107.5;
  double roll = 0, pitch = 0, heading = 0, wander = 0;

  std::string bytes() const {
    const double numbers[17] = {time, latitude, longitude, altitude, 1,     2,
                                3,    roll,     pitch,     heading,  wander};
    std::string text(sizeof numbers, '\0');
    std::memcpy(text.data(), numbers, sizeof numbers);
    return text;
  }
};

}  // namespace clearway::test
