#pragma once

#include <string>

namespace clearway::test {

/// A LandXML file with one alignment along northing 0: 100 m of line, a left arc of radius 50 m
/// over a quarter, and a profile that climbs by 1 %. Members are spoiled by tests.
struct LandFile {
  std::string units = R"(<Metric linearUnit="meter"/>)";
  std::string attributes = R"(name="a" staStart="1000" length="178.539816339745")";
  std::string line = R"(<Line length="100"><Start>0 0</Start><End>0 100</End></Line>)";
  std::string curve = R"(<Curve rot="ccw" radius="50" length="78.539816339745">)"
                      R"(<Start>0 100</Start><Center>50 100</Center><End>50 150</End></Curve>)";
  std::string profile =
      R"(<Profile><ProfAlign name="p"><PVI>1000 10</PVI><PVI>1200 12</PVI></ProfAlign></Profile>)";
  std::string more = "";   ///< further children of the alignment
  std::string other = "";  ///< what stands before Alignments

  std::string text() const {
    return "<?xml version=\"1.0\"?>\n<LandXML version=\"1.2\">\n<Units>" + units + "</Units>\n" +
           other + "<Alignments>\n<Alignment " + attributes + ">\n<CoordGeom>\n" + line + "\n" +
           curve + "\n</CoordGeom>\n" + profile + "\n" + more +
           "</Alignment>\n</Alignments>\n</LandXML>\n";
  }
};

/// The element Cant with these attributes and stations.
inline std::string cant_of(const std::string& attributes, const std::string& stations) {
  return "<Cant name=\"c\" " + attributes + ">" + stations + "</Cant>";
}

inline std::string cant_station(double station, double applied, const std::string& more) {
  return "<CantStation station=\"" + std::to_string(station) + "\" appliedCant=\"" +
         std::to_string(applied) + "\" " + more + "/>";
}

}  // namespace clearway::test
