#include "findings/row_pieces.hpp"

#include <atomic>
#include <string>

#include "io/files/input_error.hpp"
#include "io/scans/requantize.hpp"

namespace clearway {

template <typename Rows>
void requantize(const ResultReader& result, const Rows& rows, std::span<QuantumPoint> out) {
  std::atomic<std::size_t> bad{rows.size()};
  in_pieces(rows.size(), [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      for (int k = 0; k < 3; ++k) {
        const auto q = quantum_at(result.header().quantisation, k, rows.xyz[i][k]);
        out[i].q[k] = q.value_or(0);
        std::size_t least = bad.load();
        while (!q && i < least && !bad.compare_exchange_weak(least, i)) continue;
      }
    }
  });
  if (bad == rows.size()) return;
  refuse(result.name(), std::string("/") + Table<Rows>::kGroup + "/xyz, source " +
                            std::to_string(rows.source[bad]) +
                            ": expected a whole multiple of the scale above the offset");
}

template void requantize(const ResultReader&, const Collisions&, std::span<QuantumPoint>);
template void requantize(const ResultReader&, const Nearby&, std::span<QuantumPoint>);

}  // namespace clearway
