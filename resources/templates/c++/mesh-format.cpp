// My plugin: a format of surfaces, read and written. A file: the word my_plugin, how many points and triangles follow, then
// three coordinates (mm) a point and three numbers of points (from 0) a triangle.
#include <array>
#include <cstdint>
#include <locale>
#include <sstream>
#include <string>
#include <vector>

#include "c3de/sdk/sdk.hpp"

namespace {

namespace sdk = c3de::sdk;

sdk::Result<void> readMesh(const sdk::MeshSource &source, sdk::Progress progress, const sdk::MeshSink &sink) {
  std::istringstream in{std::string(source.bytes)};
  in.imbue(std::locale::classic());
  std::string word;
  std::uint64_t points = 0, triangles = 0;
  if (!(in >> word >> points >> triangles)) return sdk::Failure{C3DE_E_FORMAT, "does not say how much follows"};
  // Every number is a byte at least: what a damaged file claims is not believed.
  if (points > source.bytes.size() || triangles > source.bytes.size())
    return sdk::Failure{C3DE_E_FORMAT, "is shorter than it says"};
  std::vector<sdk::Vec3> vertices(points);
  std::vector<std::array<std::uint32_t, 3>> faces(triangles);
  const auto fails = [&](const char *what, std::size_t number) {
    return sdk::Failure{C3DE_E_FORMAT, std::string(what) + " " + std::to_string(number) + " is not three numbers"};
  };
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (!(in >> vertices[i][0] >> vertices[i][1] >> vertices[i][2])) return fails("point", i);
    if (i % 10000 == 0 && !progress.update(0.0, "reading points")) return sdk::Failure{C3DE_E_CANCELLED, "cancelled"};
  }
  for (std::size_t i = 0; i < faces.size(); ++i)
    if (!(in >> faces[i][0] >> faces[i][1] >> faces[i][2])) return fails("triangle", i);
  sink.setUnit(C3DE_UNIT_MM);
  sink.addVertices(vertices);
  sink.addTriangles(faces);
  return {};
}

sdk::Result<void> writeMesh(const sdk::MeshContents &mesh, sdk::Progress progress, c3de_sink bytes) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(17);
  out << "my_plugin " << mesh.positions.size() << ' ' << mesh.triangles.size() << '\n';
  for (const sdk::Vec3 &x : mesh.positions) out << x[0] << ' ' << x[1] << ' ' << x[2] << '\n';
  if (!progress.update(0.5, "writing triangles")) return sdk::Failure{C3DE_E_CANCELLED, "cancelled"};
  for (const auto &t : mesh.triangles) out << t[0] << ' ' << t[1] << ' ' << t[2] << '\n';
  if (const c3de_status status = sdk::put(bytes, out.str()); status < 0) return sdk::currentHost().failure(status);
  return {};
}

class MyPlugin {
 public:
  static constexpr sdk::PluginInfo info{
      .id = "org.example.my_plugin", .version = "0.1.0", .displayName = "My plugin", .vendor = "Your name", .license = "MIT"};
  static constexpr std::array needs{sdk::required<c3de_files_v1>(2)};

  explicit MyPlugin(sdk::Host host) {
    const sdk::Files files(host);
    const sdk::MeshFormat format{
        .id = "org.example.my_plugin", .label = "My plugin", .extensions = {"mine"}, .magic = "my_plugin "};
    reader_ = sdk::orThrow(files.addMeshReader(format, readMesh));
    writer_ = sdk::orThrow(files.addMeshWriter(format, writeMesh));
  }

 private:
  sdk::MeshReader reader_;
  sdk::MeshWriter writer_;
};

}  // namespace

C3DE_DEFINE_PLUGIN(MyPlugin)
