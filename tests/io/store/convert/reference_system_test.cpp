// What a conversion makes of the coordinate reference systems and units that scans name.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include "clearway/error.hpp"
#include "io/store/convert/convert.hpp"
#include "io/store/store_reader.hpp"
#include "support/bytes/las_bytes.hpp"
#include "support/catch.hpp"
#include "support/compare.hpp"
#include "support/store_fixture.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

const std::string kUtm32 =
    R"(PROJCS["UTM 32",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],)"
    R"(PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],)"
    R"(PROJECTION["Transverse_Mercator"],PARAMETER["latitude_of_origin",0],)"
    R"(PARAMETER["central_meridian",9],PARAMETER["scale_factor",0.9996],)"
    R"(PARAMETER["false_easting",500000],PARAMETER["false_northing",0],UNIT["metre",1]])";
const std::string kFeetHeights =
    R"(VERT_CS["v",VERT_DATUM["d",2005],UNIT["US survey foot",0.3048006096012192],AXIS["h",UP]])";

/// A scan of three points, 10 by 10 by 20 units, by its middle, the text of its system and its
/// GeoTIFF keys.
struct MapScan {
  std::string text = {};
  std::vector<std::array<std::uint16_t, 2>> keys = {};
  double easting = 500'000, northing = 5'300'000;

  std::string bytes() const {
    LasBytes las;
    las.scale = {0.001, 0.001, 0.001};
    las.offset = {easting, northing, 0};
    las.points = {{-5000, -5000, 0}, {5000, 5000, 20'000}, {0, 0, 10'000}};
    if (!text.empty()) las.vlrs.push_back({"LASF_Projection", 2112, text});
    if (!keys.empty()) {
      std::vector<std::uint16_t> words{1, 1, 0, static_cast<std::uint16_t>(keys.size())};
      for (const auto& [key, value] : keys) words.insert(words.end(), {key, 0, 1, value});
      las.vlrs.push_back({"LASF_Projection",
                          34735,
                          {reinterpret_cast<const char*>(words.data()), words.size() * 2}});
    }
    return las.build();
  }
};

struct Outcome {
  std::string refusal = {};
  std::string messages = " ";  ///< the codes of notes and warnings, with spaces around
  Remedy remedy = Remedy::kNone;
  double amount = 0;
  ConversionReport report = {};

  bool has(const std::string& code) const {
    return messages.find(" " + code + " ") != messages.npos;
  }
};

using NamedFiles = std::vector<std::pair<std::string, std::string>>;

Outcome outcome_of_files(const NamedFiles& files, const ConvertOptions& how = {}) {
  const ScratchFolder folder;
  ConversionOptions options{how, {}, folder / "a.h5"};
  for (const auto& [name, bytes] : files) {
    put_bytes(folder / name, bytes);
    options.inputs.push_back(folder / name);
  }
  Outcome out;
  options.message = [&](const Message& message) { out.messages += message.code + " "; };
  try {
    out.report = convert_quietly(options);
  } catch (const InputError& error) {
    out.refusal = error.what();
    out.remedy = error.remedy();
    out.amount = error.amount();
  }
  return out;
}

Outcome outcome_of(const MapScan& scan, const ConvertOptions& how = {}) {
  return outcome_of_files({{"a.las", scan.bytes()}}, how);
}

/// A warning of this code; fails where there is none.
const Message& warning(const Outcome& outcome, const std::string& code) {
  const auto& all = outcome.report.warnings;
  const auto found = std::ranges::find(all, code, &Message::code);
  INFO(outcome.messages << outcome.refusal);
  REQUIRE(found != all.end());
  return *found;
}

double number_of(const Message& message, const std::string& name) {
  for (const auto& [key, value] : message.numbers) {
    if (key == name) return value;
  }
  return 0;
}

}  // namespace

TEST_CASE("heights in another unit are refused, named, converted, or ignored with a warning") {
  const double foot = kMetresPerUsSurveyFoot;
  const std::string third =
      R"(ENGCRS["a",EDATUM["x"],CS[Cartesian,3],AXIS["x",east,LENGTHUNIT["metre",1]],)"
      R"(AXIS["y",north,LENGTHUNIT["metre",1]],)"
      R"(AXIS["z",up,LENGTHUNIT["US survey foot",0.3048006096012192]]])";
  const std::vector<MapScan> scans{{kUtm32 + "," + kFeetHeights},
                                   {kUtm32 + "]," + kFeetHeights},
                                   {"COMPD_CS[\"c\"," + kUtm32 + "," + kFeetHeights + "]"},
                                   {"COMPD_CS[\"c\", " + kUtm32 + "], " + kFeetHeights + "]"},
                                   {third},
                                   {"", {{1024, 1}, {3072, 32632}, {4096, 6360}}},
                                   {"", {{1024, 1}, {3072, 32632}, {4099, 9003}}},
                                   {kUtm32, {{4099, 9003}}}};
  for (const MapScan& scan : scans) {
    INFO(scan.text << " and " << scan.keys.size() << " keys");
    const Outcome refused = outcome_of(scan);
    check_says(refused.refusal,
               "its heights are in us-survey-foot, its other coordinates in metre");
    CHECK(refused.remedy == Remedy::kIgnoreCrs);
    check_near(refused.amount, foot, 1e-9);
    check_says(outcome_of(scan, {.unit_z = FileUnit::named("m")}).refusal,
               "its heights are in us-survey-foot, but metre was given");
    const Outcome converted = outcome_of(scan, {.unit_z = FileUnit::named("us-ft")});
    REQUIRE(converted.refusal.empty());
    CHECK(converted.report.warnings.empty());
    check_near(converted.report.box->hi.z, 20 * foot, 1e-12);
    CHECK(converted.report.metadata.quantisation.scale[2] == 0.001 * foot);
    check_equal(converted.report.largest_change, 0);
    const Outcome ignored = outcome_of(scan, {.ignore_crs = true});
    check_equal(ignored.report.box->hi.z, 20);
    check_equal(ignored.report.warnings.size(), 1);
    check_says(warning(ignored, "crs-ignored").text, "its heights are in");
  }
}

TEST_CASE("heights in the other of the two feet, or without a unit, go with the plane") {
  for (const MapScan& scan : std::vector<MapScan>{{"", {{1024, 1}, {3076, 9002}, {4099, 9003}}},
                                                  {"", {{1024, 1}, {3076, 9003}, {4099, 9002}}},
                                                  {"", {{1024, 1}, {3076, 9003}}}}) {
    const Outcome outcome = outcome_of(scan);
    CHECK(outcome.refusal.empty());
    check_equal(outcome.messages, " feet ");
  }
  check_equal(outcome_of(MapScan{kUtm32}).messages, " ");
}

TEST_CASE("heights of floating-point numbers, several files and tables are converted") {
  const ConvertOptions feet{.unit_z = FileUnit::named("ft")};
  const Outcome table = outcome_of_files({{"a.xyz", "X [m],Y [m],Z [ft]\n1,2,0\n3,4,10\n"}});
  check_says(table.refusal, "its heights are in foot, its other coordinates in metre");
  const Outcome named = outcome_of_files({{"a.xyz", "X [m],Y [m],Z [ft]\n1,2,0\n3,4,10\n"}}, feet);
  REQUIRE(named.refusal.empty());
  CHECK(named.report.box->hi.z == Approx(3.048).margin(1e-6));
  check_equal(named.report.box->hi.x, 3);
  const Outcome unnamed = outcome_of_files({{"a.xyz", "1 2 0\n3 4 10\n"}}, feet);
  CHECK(unnamed.report.box->hi.z == Approx(3.048).margin(1e-6));
  const Outcome both =
      outcome_of_files({{"a.las", MapScan{}.bytes()}, {"b.las", MapScan{}.bytes()}},
                       {.unit_z = FileUnit::named("mm")});
  CHECK(both.report.box->hi.z == Approx(0.02));
  check_equal(both.report.points, 6);
  // In a plane of US survey feet, "ft" is this foot.
  const MapScan survey{"", {{1024, 1}, {3076, 9003}}};
  check_equal(outcome_of(survey, feet).report.box->hi.z, 20);
  CHECK(outcome_of(survey, {.unit_z = FileUnit::named("m")}).report.box->hi.z ==
        Approx(20 / kMetresPerUsSurveyFoot));
}

TEST_CASE("a store of converted heights is not that of other options") {
  const ScratchFolder folder;
  NoProgress progress;
  put_bytes(folder / "a.las", MapScan{}.bytes());
  ConversionOptions options = conversion_of({folder / "a.las"}, folder / "a.h5");
  options.unit_z = FileUnit::named("ft");
  convert_quietly(options);
  CHECK(StoreReader(options.output).metadata().height_unit == kMetresPerFoot);
  CHECK(is_converted(options, progress));
  options.unit_z = FileUnit::named("in");
  CHECK_FALSE(is_converted(options, progress));
  options.unit_z = {};
  CHECK_FALSE(is_converted(options, progress));
}

TEST_CASE("a system that is not read is refused, and never counts as none") {
  for (const std::string& text :
       std::vector<std::string>{"PROJCS[\"a\"]", "Local grid", kUtm32 + ",VERT_CS[\"v\"]",
                                "LOCAL_CS[\"a\",UNIT[\"metre\",1],AXIS[\"X\",EAST]"}) {
    INFO(text);
    check_says(outcome_of(MapScan{text}).refusal, "is not read");
    const Outcome ignored = outcome_of(MapScan{text}, {.ignore_crs = true});
    check_says(warning(ignored, "crs-ignored").text, "is not read");
  }
  const MapScan no_unit{"", {{1024, 1}, {3076, 32632}}};
  check_says(outcome_of(no_unit).refusal, "key 3076 is 32632 ... --unit names it");
  check_equal(outcome_of(no_unit, {.unit = FileUnit::named("m")}).messages, " crs-not-read ");
  check_equal(outcome_of(no_unit, {.ignore_crs = true}).messages, " crs-ignored ");
  const MapScan by_text{"LOCAL_CS[\"a\"]", {{1024, 1}, {3076, 32632}}};
  check_says(outcome_of(by_text).refusal, "key 3076 is 32632 ... --unit names it");
  check_equal(outcome_of(MapScan{"", {{1024, 1}, {4096, 5030}}}).messages, " crs-not-read ");
  const Outcome known = outcome_of(MapScan{"PROJCS[\"a\"]", {{1024, 1}, {3072, 32632}}});
  check_equal(known.messages, " crs-not-read ");
}

TEST_CASE("a record that places the points is refused unless it leaves them where they are") {
  const bool behind = GENERATE(false, true);  // whether in an extended record
  const auto outcome = [&](const std::string& user, std::uint16_t id, const std::string& payload,
                           bool ignore = false) {
    LasBytes las;
    if (behind) las.minor = 4;
    auto& records = behind ? las.evlrs : las.vlrs;
    auto& record = records.emplace_back();
    record.user = user;
    record.id = id;
    record.payload = payload;
    ConvertOptions how;
    how.ignore_crs = ignore;
    return outcome_of_files({{"a.las", las.build()}}, how);
  };
  const auto ptx = [](double turn, double shift) {
    std::array<double, 34> numbers{};  // the matrix is the last 16 of them
    for (const std::size_t i : {18, 23, 28, 33}) numbers[i] = 1;
    numbers[19] = turn;
    numbers[20 + 10] = shift;
    return std::string(reinterpret_cast<const char*>(numbers.data()), sizeof numbers);
  };
  for (const std::string& moves : {ptx(0.5, 0), ptx(0, 10), ptx(std::nan(""), 0)}) {
    check_says(outcome("LAStools", 2001, moves).refusal,
               "LAStools 2001 holds the matrix of a scanner ... such as PTX");
    CHECK(outcome("LAStools", 2001, moves, true).has("crs-ignored"));
  }
  check_says(outcome("LASF_Projection", 2111, "PARAM_MT[\"Affine\"]").refusal, "2111");
  for (const auto& [user, id, payload] :
       std::vector<std::tuple<std::string, std::uint16_t, std::string>>{
           {"LAStools", 2001, ptx(0, 0)},
           {"LAStools", 2001, ptx(0, 10).substr(1)},
           {"LAStools", 2000, ptx(0, 10)},
           {"LASF_Spec", 7, ptx(0, 10)},
           {"LASF_Projection", 2111, ""}}) {
    CHECK(outcome(user, id, payload).refusal.empty());
  }
}

TEST_CASE("a map that does not keep lengths is warned of, and refused above 5 %") {
  struct Case {
    std::string text;
    double easting, northing, scale;
  };
  const std::string compound = "EPSG:3857+5773";
  for (const Case& one : std::vector<Case>{{"EPSG:3857", 1224514.4, 6106854.8, 1.4962},
                                           {compound, 1224514.4, 6106854.8, 1.4962},
                                           {"EPSG:3395", 1113194.9, 8362698.5, 1.9950},
                                           {kUtm32, 3'000'000, 5'300'000, 1.0774}}) {
    INFO(one.text);
    const MapScan scan{one.text, {}, one.easting, one.northing};
    const Outcome refused = outcome_of(scan);
    check_says(refused.refusal, std::string(std::to_string(one.scale).substr(0, 4)) +
                                    " ... times those on the ground");
    CHECK(refused.remedy == Remedy::kIgnoreCrs);
    const Outcome ignored = outcome_of(scan, {.ignore_crs = true});
    CHECK(number_of(warning(ignored, "map-scale"), "scale") == Approx(one.scale).margin(1e-3));
    check_equal(ignored.report.metadata.warnings.size(), 1);
  }
  const Outcome polar = outcome_of(MapScan{"EPSG:3031", {}, 1419227.9, 819391.6});
  CHECK(number_of(warning(polar, "map-scale"), "scale") == Approx(0.98963).margin(1e-4));
  for (const MapScan& scan :
       std::vector<MapScan>{{kUtm32},
                            {kUtm32, {}, 166'000, 10'000},
                            {kUtm32, {}, 834'000, 10'000},
                            {"EPSG:2193", {}, 1'750'000, 5'426'000},
                            {"EPSG:4978", {}, 4'000'000, 600'000},
                            {"LOCAL_CS[\"a\",UNIT[\"metre\",1]]", {}, 0, 0}}) {
    INFO(scan.text);
    check_equal(outcome_of(scan).messages, " ");
  }
  check_equal(outcome_of(MapScan{"EPSG:5514", {}, 1e9, 1e9}).messages, " map-scale-unknown ");
  // Named in feet, coordinates on a map in metres lie where they do in metres.
  const double foot = kMetresPerUsSurveyFoot;
  const MapScan contradicting{
      "", {{1024, 1}, {3072, 32632}, {3076, 9003}}, 500'000 / foot, 5'300'000 / foot};
  check_equal(outcome_of(contradicting).messages, " units-contradict feet ");
}

TEST_CASE("the map of every input is judged, at the middle of its own files") {
  const std::string utm = MapScan{kUtm32}.bytes();
  const std::string web = MapScan{"EPSG:3857", {}, 1'224'514, 6'106'854}.bytes();
  for (const NamedFiles& files : std::vector<NamedFiles>{
           {{"a.las", utm}, {"b.las", web}}, {{"a.las", utm}, {"b.las", web}, {"c.las", utm}}}) {
    const Outcome refused = outcome_of_files(files);
    check_says(refused.refusal, "b.las: lengths on the map of WGS 84 / Pseudo-Mercator");
    const Outcome ignored = outcome_of_files(files, {.ignore_crs = true});
    CHECK(ignored.messages.find("map-scale") == ignored.messages.rfind("map-scale"));
    CHECK(number_of(warning(ignored, "map-scale"), "scale") == Approx(1.4962).margin(1e-3));
    check_says(warning(ignored, "map-scale").text, "b.las: lengths on the map");
  }
  const std::string unnamed = MapScan{}.bytes();
  check_equal(outcome_of_files({{"a.las", utm}, {"b.las", unnamed}}).messages, " no-crs ");
}

TEST_CASE("a store of an ignored system is not that of options which do not ignore it") {
  const ScratchFolder folder;
  NoProgress progress;
  put_bytes(folder / "a.las", MapScan{"EPSG:3857", {}, 1224514.4, 6106854.8}.bytes());
  ConversionOptions options = conversion_of({folder / "a.las"}, folder / "a.h5");
  options.ignore_crs = true;
  convert_quietly(options);
  CHECK(is_converted(options, progress));
  options.ignore_crs = false;
  CHECK_FALSE(is_converted(options, progress));
}

TEST_CASE("numbers that look like degrees are warned of where nothing names a unit") {
  const auto scan = [](double x, double y, double length, double height) {
    std::string text;
    for (int i = 0; i <= 10; ++i) {
      const double share = i / 10.0;
      text += std::to_string(x + length * share) + " " +
              std::to_string(y + length * share * share) + " " + std::to_string(height * share) +
              "\n";
    }
    return NamedFiles{{"a.xyz", text}};
  };
  CHECK(outcome_of_files(scan(11.5, 48.1, 0.02, 35)).has("like-degrees"));
  CHECK(outcome_of_files(scan(-94.66, 31.03, 0.0229, 39)).has("like-degrees"));
  CHECK(outcome_of_files(scan(48.1, 11.5, 0.5, 300)).has("like-degrees"));
  CHECK_FALSE(outcome_of_files(scan(11.5, 48.1, 0.02, 35), {.unit = FileUnit::named("m")})
                  .has("like-degrees"));
  CHECK_FALSE(outcome_of_files(scan(0, 0, 20, 35)).has("like-degrees"));
  CHECK_FALSE(outcome_of_files(scan(11.5, 48.1, 1, 20)).has("like-degrees"));
  CHECK_FALSE(outcome_of_files(scan(500'000, 5'300'000, 0.5, 60)).has("like-degrees"));
  CHECK_FALSE(outcome_of_files(scan(0, 0, 0, 10)).has("like-degrees"));
}
