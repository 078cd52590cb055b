#include "io/scans/laz/items/point14.hpp"

#include "io/files/bytes.hpp"

namespace clearway::laz {

void Point14::begin(const std::byte* record, bool has_heights) {
  has_heights_ = has_heights;
  for (Channel& channel : channels_) channel.used = false;
  const auto returns = load<std::uint8_t>(record + 14);
  const auto flags = load<std::uint8_t>(record + 15);
  Channel first;
  first.position = load<Quanta>(record);
  first.point_class = load<std::uint8_t>(record + 16);
  first.flags = static_cast<std::uint8_t>((flags & 15u) | (flags >> 6 & 3u) << 4);
  first.return_number = returns & 15u;
  first.number_of_returns = returns >> 4;
  current_ = flags >> 4 & 3u;
  start(channels_[current_], first);
}

void Point14::begin_times(double time) {
  for (const auto& times : times_) {
    if (times) times->used = false;
  }
  start_times(current_, time);
}

void Point14::start_times(unsigned channel, double time) {
  std::unique_ptr<Times>& times = times_[channel];
  if (!times) times = std::make_unique<Times>();
  times->sequences.begin(time);
  times->used = true;
  last_timed_ = channel;
}

double Point14::next_time(ArithmeticDecoder& layer) {
  // A channel begins with the time of the point before.
  if (!times_[current_] || !times_[current_]->used) {
    start_times(current_, times_[last_timed_]->sequences.time());
  }
  last_timed_ = current_;
  GpsTimeLayer& sequences = times_[current_]->sequences;
  if (channels_[current_].time_changed) layer = sequences.next(layer);
  return sequences.time();
}

/// Begins a channel with the last point of another one.
void Point14::start(Channel& channel, const Channel& from) {
  renew(channel.models);
  const auto index = static_cast<std::size_t>(&channel - channels_.data());
  class_models_[index].renew();
  flag_models_[index].renew();
  channel.used = true;
  channel.position = from.position;
  channel.heights.fill(from.position[2]);
  channel.point_class = from.point_class;
  channel.flags = from.flags;
  channel.number_of_returns = from.number_of_returns;
  channel.return_number = from.return_number;
  channel.time_changed = false;
}

ArithmeticDecoder Point14::next_channel(ArithmeticDecoder plane) {
  const Channel& last = channels_[current_];
  const unsigned next = (current_ + 1 + plane.symbol(last.models->channel)) % 4;
  if (!channels_[next].used) start(channels_[next], last);
  current_ = next;
  return plane;
}

ArithmeticDecoder Point14::next_returns(ArithmeticDecoder plane, unsigned changed) {
  Channel& channel = channels_[current_];
  Models& models = *channel.models;
  if ((changed & kReturnsChanged) != 0) {
    channel.number_of_returns = plane.symbol(models.number_of_returns[channel.number_of_returns]);
  }
  const unsigned last = channel.return_number;
  switch (changed & kReturnChange) {
    case 1:
      channel.return_number = (last + 1) % 16;
      break;
    case 2:
      channel.return_number = (last + 15) % 16;
      break;
    case 3:
      channel.return_number = (changed & kTimeChanged) != 0
                                  ? plane.symbol(models.return_number[last])
                                  : (last + 2 + plane.symbol(models.return_number_same_time)) % 16;
      break;
    default:
      break;
  }
  return plane;
}

}  // namespace clearway::laz
