#include "io/scans/laz/items/point10.hpp"

#include "io/files/bytes.hpp"

namespace clearway::laz {

Point10Fields::Point10Fields(const std::byte* record)
    : position(load<Quanta>(record)),
      returns(load<std::uint8_t>(record + 14)),
      classification(load<std::uint8_t>(record + 15)),
      user_data(load<std::uint8_t>(record + 17)) {}

void Point10Version2::begin(const std::byte* record) {
  last_ = Point10Fields(record);
  renew(models_);
  returns_.renew();
  classification_.renew();
  user_data_.renew();
}

ArithmeticDecoder Point10Version2::next_attributes(ArithmeticDecoder decoder, unsigned changed) {
  if ((changed & Point10Changes::kIntensity) != 0) {
    const unsigned map = kReturnMap10[last_.number_of_returns()][last_.return_number()];
    models_->intensity.decode(decoder, 0, std::min(map, 3u));
  }
  if ((changed & Point10Changes::kClassification) != 0) {
    last_.classification = classification_.decode(decoder, last_.classification);
  }
  if ((changed & Point10Changes::kScanAngle) != 0) {
    decoder.symbol(models_->scan_angle[last_.scan_direction()]);
  }
  if ((changed & Point10Changes::kUserData) != 0) {
    last_.user_data = user_data_.decode(decoder, last_.user_data);
  }
  if ((changed & Point10Changes::kSource) != 0) models_->source.decode(decoder, 0, 0);
  return decoder;
}

void Point10Version1::begin(const std::byte* record) {
  last_ = Point10Fields(record);
  renew(models_);
  returns_.renew();
  classification_.renew();
  user_data_.renew();
}

ArithmeticDecoder Point10Version1::next_attributes(ArithmeticDecoder decoder, unsigned changed,
                                                   unsigned width) {
  if ((changed & Point10Changes::kOldIntensity) != 0) models_->intensity.decode(decoder, 0, 0);
  if ((changed & Point10Changes::kOldReturns) != 0) {
    last_.returns = returns_.decode(decoder, last_.returns);
  }
  if ((changed & Point10Changes::kClassification) != 0) {
    last_.classification = classification_.decode(decoder, last_.classification);
  }
  if ((changed & Point10Changes::kScanAngle) != 0) {
    models_->scan_angle.decode(decoder, 0, width < 3 ? 1 : 0);
  }
  if ((changed & Point10Changes::kUserData) != 0) {
    last_.user_data = user_data_.decode(decoder, last_.user_data);
  }
  if ((changed & Point10Changes::kSource) != 0) models_->source.decode(decoder, 0, 0);
  return decoder;
}

}  // namespace clearway::laz
