#include "io/scans/laz/items/other_items.hpp"

namespace clearway::laz {

ArithmeticDecoder RgbVersion2::next(ArithmeticDecoder decoder) {
  constexpr unsigned kOthers = 64;  // bit of `changed`: green and blue differ from red
  const unsigned changed = decoder.symbol(models_.changed);
  // Each bit stands for a byte, in the order of the record; the low bytes of green and blue come
  // first.
  for (const unsigned byte : {0u, 1u, 2u, 4u, 3u, 5u}) {
    if (byte > 1 && (changed & kOthers) == 0) break;
    if ((changed >> byte & 1u) != 0) decoder.symbol(models_.bytes[byte]);
  }
  return decoder;
}

ArithmeticDecoder RgbVersion1::next(ArithmeticDecoder decoder) {
  const unsigned changed = decoder.symbol(models_.changed);
  for (unsigned byte = 0; byte < 6; ++byte) {
    if ((changed >> byte & 1u) != 0) models_.bytes.decode(decoder, 0, byte);
  }
  return decoder;
}

ArithmeticDecoder WavePacket::next(ArithmeticDecoder decoder) {
  decoder.symbol(models_.descriptor);
  models_.last_kind = decoder.symbol(models_.offset_kind[models_.last_kind]);
  if (models_.last_kind == 2) {
    models_.offset.decode(decoder, 0, 0);
  } else if (models_.last_kind == 3) {
    for (int i = 0; i < 4; ++i) decoder.bits(16);
  }
  models_.size.decode(decoder, 0, 0);
  models_.location.decode(decoder, 0, 0);
  for (unsigned axis = 0; axis < 3; ++axis) models_.direction.decode(decoder, 0, axis);
  return decoder;
}

void BytesVersion2::begin() {
  for (auto& model : models_) renew(model);
}

ArithmeticDecoder BytesVersion2::next(ArithmeticDecoder decoder) {
  for (auto& model : models_) decoder.symbol(model);
  return decoder;
}

void BytesVersion1::begin() {
  for (auto& model : widths_) renew(model);
  renew(corrector_);
}

ArithmeticDecoder BytesVersion1::next(ArithmeticDecoder decoder) {
  unsigned width = 0;
  for (auto& model : widths_) corrector_.decode(decoder, model, width);
  return decoder;
}

}  // namespace clearway::laz
