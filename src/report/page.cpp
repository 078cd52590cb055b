#include "report/page.hpp"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string_view>
#include <tuple>
#include <utility>

#include "findings/row_pieces.hpp"
#include "io/files/deflate.hpp"
#include "io/files/file.hpp"
#include "io/files/parallel_loop.hpp"
#include "io/result/conflicts/markup_text.hpp"

namespace clearway {
namespace {

constexpr int kDeflateLevel = 6;
constexpr int kCurveBits = 21;  // bits of each axis

/// The lowest 21 bits, with two zero bits between neighbouring ones.
std::uint64_t spread_bits(std::uint64_t v) {
  v &= 0x1fffff;
  v = (v | v << 32) & 0x1f00000000ffff;
  v = (v | v << 16) & 0x1f0000ff0000ff;
  v = (v | v << 8) & 0x100f00f00f00f00f;
  v = (v | v << 4) & 0x10c30c30c30c30c3;
  v = (v | v << 2) & 0x1249249249249249;
  return v;
}

struct Placed {
  std::uint64_t key;
  PagePoint point;
  friend bool operator<(const Placed& a, const Placed& b) {
    const auto all = [](const Placed& placed) {
      const PagePoint& p = placed.point;
      return std::tuple(placed.key, p.q[0], p.q[1], p.q[2], p.tag);
    };
    return all(a) < all(b);
  }
};

}  // namespace

PageLattice lattice_for(const Box& box, double finest) {
  PageLattice lattice;
  double extent = 0;
  for (int k = 0; k < 3; ++k) {
    lattice.origin[k] = std::round((box.lo[k] + box.hi[k]) / 2);
    extent = std::max(extent, box.hi[k] - box.lo[k]);
  }
  lattice.step = std::max(finest, extent / 0x1p29);
  return lattice;
}

PagePoint page_point(const PageLattice& lattice, const Vec3& xyz, std::uint8_t tag) {
  PagePoint out{.q = {}, .tag = tag};
  for (int k = 0; k < 3; ++k) {
    const double q = (xyz[k] - lattice.origin[k]) / lattice.step;
    out.q[k] = static_cast<std::int32_t>(std::clamp(std::round(q), -0x1p30, 0x1p30));
  }
  return out;
}

void sort_along_curve(std::vector<PagePoint>& points) {
  if (points.empty()) return;
  std::int32_t lo[3];
  std::int64_t extent = 1;
  for (int k = 0; k < 3; ++k) {
    const auto coordinate = [k](const PagePoint& point) { return point.q[k]; };
    const auto [least, most] = std::ranges::minmax_element(points, {}, coordinate);
    lo[k] = least->q[k];
    extent = std::max<std::int64_t>(extent, std::int64_t{most->q[k]} - lo[k]);
  }
  int shift = 0;
  while (extent >> shift >= std::int64_t{1} << kCurveBits) ++shift;
  std::vector<Placed> placed(points.size());
  for_each_parallel(points.size(), [&](std::size_t i) {
    std::uint64_t key = 0;
    for (int k = 0; k < 3; ++k) {
      key |= spread_bits(static_cast<std::uint64_t>(std::int64_t{points[i].q[k]} - lo[k]) >> shift)
             << k;
    }
    placed[i] = {key, points[i]};
  });
  tbb::parallel_sort(placed.begin(), placed.end());
  for_each_parallel(points.size(), [&](std::size_t i) { points[i] = placed[i].point; });
}

std::string delta_planes(std::span<const std::int32_t> values) {
  const std::size_t n = values.size();
  std::string out(4 * n, '\0');
  std::uint32_t previous = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const auto value = static_cast<std::uint32_t>(values[i]);
    const auto delta = static_cast<std::int32_t>(value - previous);
    const auto zigzag =
        static_cast<std::uint32_t>(delta) << 1 ^ static_cast<std::uint32_t>(delta >> 31);
    for (std::size_t plane = 0; plane < 4; ++plane) {
      out[plane * n + i] = static_cast<char>(zigzag >> (8 * plane) & 0xff);
    }
    previous = value;
  }
  return out;
}

namespace {

/// The bytes compressed in zlib format, then in base64.
std::string deflated_base64(std::string_view bytes) {
  static constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const std::string deflated = deflated_in_blocks(bytes, kDeflateLevel);
  std::string out((deflated.size() + 2) / 3 * 4, '=');
  const auto encode = [&](std::size_t i) {
    const std::size_t here = std::min<std::size_t>(3, deflated.size() - 3 * i);
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      three = three << 8 | (k < here ? static_cast<unsigned char>(deflated[3 * i + k]) : 0U);
    }
    for (std::size_t k = 0; k <= here; ++k) out[4 * i + k] = kDigits[three >> (18 - 6 * k) & 63];
  };
  in_pieces(out.size() / 4, [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) encode(i);
  });
  return out;
}

}  // namespace

void append_columns(const std::string& name, const std::vector<PagePoint>& points,
                    std::vector<PageColumn>& columns) {
  std::vector<std::int32_t> values(points.size());
  for (int k = 0; k < 3; ++k) {
    for (std::size_t i = 0; i < points.size(); ++i) values[i] = points[i].q[k];
    columns.push_back({name + "." + "xyz"[k], delta_planes(values)});
  }
  std::string tags;
  for (const PagePoint& point : points) tags += static_cast<char>(point.tag);
  columns.push_back({name + ".tag", std::move(tags)});
}

Json page_head(const PageTexts& texts, const std::string& title) {
  return {{"clearway", CLEARWAY_VERSION}, {"title", title},         {"project", texts.project},
          {"client", texts.client},       {"author", texts.author}, {"date", texts.date}};
}

std::uint64_t write_page(const std::filesystem::path& path, std::string_view page,
                         PageContent content) {
  for_each_parallel(content.columns.size(), [&](std::size_t i) {
    content.columns[i].bytes = deflated_base64(content.columns[i].bytes);
  });
  File file = File::create(path);
  std::uint64_t bytes = 0;
  const auto write = [&](std::string_view text) {
    file.write(std::as_bytes(std::span(text)));
    bytes += text.size();
  };
  constexpr std::string_view kOpen = "{{", kClose = "}}";
  for (std::size_t open = 0; (open = page.find(kOpen)) != std::string_view::npos;) {
    write(page.substr(0, open));
    page.remove_prefix(open + kOpen.size());
    const std::string_view name = page.substr(0, page.find(kClose));
    page.remove_prefix(name.size() + kClose.size());
    if (name == "TITLE") write(markup_text(content.title));
    if (name == "SECTION") write(content.section);
    if (name == "FACTS") write(content.facts);
    if (name != "COLUMNS") continue;
    for (const PageColumn& column : content.columns) {
      write(R"(<script type="text/plain" data-column=")" + column.name + R"(">)");
      write(column.bytes);
      write("</script>\n");
    }
  }
  write(page);
  return bytes;
}

}  // namespace clearway
