// What a conversion makes of the coordinate reference systems and units that scans name.
#include <cmath>
#include <tuple>

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
  std::string codes = {};  ///< of notes and warnings: "note a, b"
  Remedy remedy = Remedy::kNone;
  double amount = 0;
  ConversionReport report = {};

  /// The only message, a warning of this code; fails where there is another or none.
  const Message& only(const std::string& code) const {
    INFO(refusal);
    REQUIRE(codes == code);
    return report.warnings.at(0);
  }
};

using NamedFiles = std::vector<std::pair<std::string, std::string>>;

Outcome outcome_of_files(const NamedFiles& files, const ConvertOptions& how = {}) {
  Conversion conversion;
  conversion.options = {how, {}, conversion.folder / "a.h5"};
  for (const auto& [name, bytes] : files) conversion.add(name, bytes);
  Outcome out;
  std::vector<Message> messages;
  conversion.options.message = [&](const Message& message) { messages.push_back(message); };
  try {
    out.report = conversion.convert();
  } catch (const InputError& error) {
    out.refusal = error.what();
    out.remedy = error.remedy();
    out.amount = error.amount();
  }
  out.codes = codes_of(messages);
  return out;
}

Outcome outcome_of(const MapScan& scan, const ConvertOptions& how = {}) {
  return outcome_of_files({{"a.las", scan.bytes()}}, how);
}

}  // namespace

TEST_CASE("heights in another unit are refused, named, converted, or ignored with a warning") {
  const double foot = kMetresPerUsSurveyFoot;
  const std::string third =
      R"(ENGCRS["a",EDATUM["x"],CS[Cartesian,3],AXIS["x",east,LENGTHUNIT["metre",1]],)"
      R"(AXIS["y",north,LENGTHUNIT["metre",1]],)"
      R"(AXIS["z",up,LENGTHUNIT["US survey foot",0.3048006096012192]]])";
  for (const MapScan& scan :
       std::vector<MapScan>{{kUtm32 + "," + kFeetHeights},
                            {kUtm32 + "]," + kFeetHeights},
                            {"COMPD_CS[\"c\"," + kUtm32 + "," + kFeetHeights + "]"},
                            {"COMPD_CS[\"c\", " + kUtm32 + "], " + kFeetHeights + "]"},
                            {third},
                            {"", {{1024, 1}, {3072, 32632}, {4096, 6360}}},
                            {"", {{1024, 1}, {3072, 32632}, {4099, 9003}}},
                            {kUtm32, {{4099, 9003}}}}) {
    INFO(scan.text << " and " << scan.keys.size() << " keys");
    const Outcome refused = outcome_of(scan);
    check_says(refused.refusal,
               "its heights are in us-survey-foot, its other coordinates in metre");
    CHECK(refused.remedy == Remedy::kIgnoreCrs);
    check_near(refused.amount, foot, 1e-9);
    check_says(outcome_of(scan, {.unit_z = FileUnit::named("m")}).refusal,
               "its heights are in us-survey-foot, but metre was given");
    const Outcome converted = outcome_of(scan, {.unit_z = FileUnit::named("us-ft")});
    check_equal(converted.refusal + converted.codes, "");
    check_near(converted.report.box.value().hi.z, 20 * foot, 1e-12);
    check_near(converted.report.box->hi.x, 500'005, 1e-9);
    check_equal(converted.report.metadata.quantisation.scale[2], 0.001 * foot);
    check_equal(converted.report.largest_change, 0);
    const Outcome ignored = outcome_of(scan, {.ignore_crs = true});
    check_says(ignored.only("crs-ignored").text, "its heights are in");
    check_equal(ignored.report.box->hi.z, 20);
  }
}

TEST_CASE("heights of floating-point numbers, several files and tables are converted") {
  const std::string table = "X [m],Y [m],Z [ft]\n1,2,0\n3,4,10\n", metres = MapScan{}.bytes();
  const std::string survey = MapScan{"", {{1024, 1}, {3076, 9003}}}.bytes();
  check_says(outcome_of_files({{"a.xyz", table}}).refusal,
             "its heights are in foot, its other coordinates in metre");
  const auto check = [](const NamedFiles& files, const char* unit, double height,
                        double metres_of_unit, double tolerance = 1e-6) {
    CAPTURE(files[0].first, unit);
    const Outcome outcome = outcome_of_files(files, {.unit_z = FileUnit::named(unit)});
    check_equal(outcome.refusal, "");
    check_near(outcome.report.box.value().hi.z, height, tolerance);
    check_equal(outcome.report.metadata.height_unit, metres_of_unit);
  };
  check({{"a.xyz", table}}, "ft", 3.048, kMetresPerFoot);
  check({{"a.xyz", "1 2 0\n3 4 10\n"}}, "ft", 3.048, kMetresPerFoot);
  check({{"a.las", metres}, {"b.las", metres}}, "mm", 0.02, 0.001);
  // In a plane of US survey feet, "ft" is this foot.
  check({{"a.las", survey}}, "ft", 20, kMetresPerUsSurveyFoot, 0);
  check({{"a.las", survey}}, "m", 20 / kMetresPerUsSurveyFoot, 1, 1e-4);
}

TEST_CASE("a system that is not read is refused, and never counts as none") {
  for (const std::string& text :
       std::vector<std::string>{"PROJCS[\"a\"]", "Local grid", kUtm32 + ",VERT_CS[\"v\"]",
                                "LOCAL_CS[\"a\",UNIT[\"metre\",1],AXIS[\"X\",EAST]"}) {
    INFO(text);
    check_says(outcome_of({text}).refusal, "is not read");
    check_says(outcome_of({text}, {.ignore_crs = true}).only("crs-ignored").text, "is not read");
  }
  const MapScan no_unit{"", {{1024, 1}, {3076, 32632}}};
  for (const MapScan& scan : {no_unit, MapScan{"LOCAL_CS[\"a\"]", no_unit.keys}}) {
    check_says(outcome_of(scan).refusal, "key 3076 is 32632 ... --unit names it");
  }
  const auto check = [](const MapScan& scan, const std::string& codes,
                        const ConvertOptions& how = {}) {
    INFO(scan.text << " and " << scan.keys.size() << " keys");
    const Outcome outcome = outcome_of(scan, how);
    check_equal(outcome.codes, codes);
    check_equal(outcome.refusal, "");
  };
  check(no_unit, "crs-not-read", {.unit = FileUnit::named("m")});
  check(no_unit, "crs-ignored", {.ignore_crs = true});
  check({"", {{1024, 1}, {4096, 5030}}}, "crs-not-read");
  check({"PROJCS[\"a\"]", {{1024, 1}, {3072, 32632}}}, "crs-not-read");
  // Heights in the other of the two feet, or without a unit, go with the plane.
  check({"", {{1024, 1}, {3076, 9002}, {4099, 9003}}}, "feet");
  check({"", {{1024, 1}, {3076, 9003}, {4099, 9002}}}, "feet");
  check({"", {{1024, 1}, {3076, 9003}}}, "feet");
  check({kUtm32}, "");
}

TEST_CASE("a record that places the points is refused unless it leaves them where they are") {
  const bool behind = GENERATE(false, true);  // whether in an extended record
  const auto outcome = [&](const std::string& user, std::uint16_t id, const std::string& payload,
                           bool ignore = false) {
    LasBytes las;
    if (behind) las.minor = 4;
    (behind ? las.evlrs : las.vlrs).push_back({user, id, payload});
    return outcome_of_files({{"a.las", las.build()}}, {.ignore_crs = ignore});
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
    check_says(outcome("LAStools", 2001, moves, true).codes, "crs-ignored");
  }
  check_says(outcome("LASF_Projection", 2111, "PARAM_MT[\"Affine\"]").refusal, "2111");
  for (const auto& [user, id, payload] :
       std::vector<std::tuple<std::string, std::uint16_t, std::string>>{
           {"LAStools", 2001, ptx(0, 0)},
           {"LAStools", 2001, ptx(0, 10).substr(1)},
           {"LAStools", 2000, ptx(0, 10)},
           {"LASF_Spec", 7, ptx(0, 10)},
           {"LASF_Projection", 2111, ""}}) {
    check_equal(outcome(user, id, payload).refusal, "");
  }
}

TEST_CASE("a map that does not keep lengths is warned of, and refused above 5 %") {
  const double foot = kMetresPerUsSurveyFoot;
  // scale: of the map; 0: nothing is said of it.
  const auto check = [](const MapScan& scan, double scale, const std::string& codes) {
    INFO(scan.text);
    Outcome outcome = outcome_of(scan);
    if (scale > 1.05) {
      check_says(outcome.refusal,
                 std::to_string(scale).substr(0, 4) + " ... times those on the ground");
      CHECK(outcome.remedy == Remedy::kIgnoreCrs);
      outcome = outcome_of(scan, {.ignore_crs = true});
      check_equal(outcome.report.metadata.warnings.size(), 1);
    }
    check_equal(outcome.codes, codes);
    if (scale > 0) check_near(number_of(outcome.only(codes), "scale"), scale, 1e-4);
  };
  check({"EPSG:3857", {}, 1224514.4, 6106854.8}, 1.4962, "map-scale");
  check({"EPSG:3857+5773", {}, 1224514.4, 6106854.8}, 1.4962, "map-scale");
  check({"EPSG:3395", {}, 1113194.9, 8362698.5}, 1.9950, "map-scale");
  check({kUtm32, {}, 3'000'000, 5'300'000}, 1.0774, "map-scale");
  check({"EPSG:3031", {}, 1419227.9, 819391.6}, 0.98963, "map-scale");
  check({kUtm32}, 0, "");
  check({kUtm32, {}, 166'000, 10'000}, 0, "");
  check({kUtm32, {}, 834'000, 10'000}, 0, "");
  check({"EPSG:2193", {}, 1'750'000, 5'426'000}, 0, "");
  check({"EPSG:4978", {}, 4'000'000, 600'000}, 0, "");
  check({"LOCAL_CS[\"a\",UNIT[\"metre\",1]]", {}, 0, 0}, 0, "");
  check({"EPSG:5514", {}, 1e9, 1e9}, 0, "map-scale-unknown");
  // Named in feet, coordinates on a map in metres lie where they do in metres.
  check({"", {{1024, 1}, {3072, 32632}, {3076, 9003}}, 500'000 / foot, 5'300'000 / foot}, 0,
        "units-contradict, feet");
}

TEST_CASE("the map of every input is judged, at the middle of its own files") {
  const std::string utm = MapScan{kUtm32}.bytes();
  const std::string web = MapScan{"EPSG:3857", {}, 1'224'514, 6'106'854}.bytes();
  for (const NamedFiles& files : std::vector<NamedFiles>{
           {{"a.las", utm}, {"b.las", web}}, {{"a.las", utm}, {"b.las", web}, {"c.las", utm}}}) {
    check_says(outcome_of_files(files).refusal,
               "b.las: lengths on the map of WGS 84 / Pseudo-Mercator");
    std::vector<Message> scales = outcome_of_files(files, {.ignore_crs = true}).report.warnings;
    std::erase_if(scales, [](const Message& message) { return message.code != "map-scale"; });
    REQUIRE(scales.size() == 1);
    check_says(scales[0].text, "b.las: lengths on the map");
    check_near(number_of(scales[0], "scale"), 1.4962, 1e-3);
  }
  const std::string unnamed = MapScan{}.bytes();
  check_equal(outcome_of_files({{"a.las", utm}, {"b.las", unnamed}}).codes, "note no-crs");
}

TEST_CASE("numbers that look like degrees are warned of where nothing names a unit") {
  struct Row {
    double x, y, length, height;
    bool is_warned = false;
    FileUnit unit = {};
  };
  for (const Row& row : std::vector<Row>{{11.5, 48.1, 0.02, 35, true},
                                         {-94.66, 31.03, 0.0229, 39, true},
                                         {48.1, 11.5, 0.5, 300, true},
                                         {11.5, 48.1, 0.02, 35, false, FileUnit::named("m")},
                                         {0, 0, 20, 35},
                                         {11.5, 48.1, 1, 20},
                                         {500'000, 5'300'000, 0.5, 60},
                                         {0, 0, 0, 10}}) {
    CAPTURE(row.x, row.y, row.length, row.height);
    std::string text;
    for (int i = 0; i <= 10; ++i) {
      const double share = i / 10.0;
      text += std::to_string(row.x + row.length * share) + " " +
              std::to_string(row.y + row.length * share * share) + " " +
              std::to_string(row.height * share) + "\n";
    }
    const Outcome outcome = outcome_of_files({{"a.xyz", text}}, {.unit = row.unit});
    CHECK((outcome.codes.find("like-degrees") != std::string::npos) == row.is_warned);
  }
}
