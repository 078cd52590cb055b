// Which points of a scan does a model touch on its way? A program that uses the installed library.
//   find_collisions SCAN MODEL TRAJECTORY RADIUS    writes site.h5 and out.h5
#include <clearway/clearway.hpp>
#include <cstdlib>
#include <iostream>

namespace {

/// Says how far a call is. The library itself prints nothing.
void show(const clearway::ProgressUpdate& update) {
  if (update.finished)
    std::cerr << update.stage << ": " << update.done << " " << update.unit << "\n";
}

void warn(const clearway::Message& message) {
  if (message.severity != clearway::Message::Severity::kWarning) return;
  std::cerr << "warning (" << message.code << "): " << message.text << "\n";
}

void find_collisions(char** argv) {
  clearway::ConvertOptions conversion;
  conversion.memory_bytes = 1 << 30;
  conversion.progress = show;
  conversion.message = warn;
  clearway::convert({argv[1]}, "site.h5", conversion);
  clearway::Store store("site.h5");

  clearway::Query query;
  std::vector<clearway::Message> warnings;
  query.model = clearway::read_model(argv[2], {}, &warnings);
  query.poses = clearway::read_trajectory(argv[3]);
  query.radius = std::atof(argv[4]);
  clearway::SearchOptions options;
  options.threads = 2;
  options.progress = show;
  clearway::SearchReport report = clearway::search(store, query, "out.h5", options);
  warnings.insert(warnings.end(), report.warnings.begin(), report.warnings.end());
  for (const clearway::Message& warning : warnings) warn(warning);

  clearway::Result result("out.h5");
  std::cout << result.size() << " of " << store.point_count() << " points collide\n";
  if (result.size() == 0) return;
  const clearway::Vec3 point = result.xyz().front();
  std::cout << "the first is point " << result.source().front() << " at " << point.x << " "
            << point.y << " " << point.z << "\n";
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    std::cerr << "usage: find_collisions SCAN MODEL TRAJECTORY RADIUS\n";
    return EXIT_FAILURE;
  }
  try {
    find_collisions(argv);
  } catch (const clearway::Error& error) {
    std::cerr << error.what() << "\n";
    return EXIT_FAILURE;
  }
}
