// SPDX-License-Identifier: Apache-2.0
// Calls functions of the host's services in random order with values on the limits. Whatever they return, the process
// must survive, and reported success must be real; sanitizers detect more.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <type_traits>
#include <vector>

#include "boundary_values.h"
#include "c3de/core/crash_journal.h"
#include "c3de/registry/text_panel.h"
#include "c3de/sdk/ids.hpp"
#include "trial_host.h"

namespace {

using fuzz::BoundaryValues;
using Clock = std::chrono::steady_clock;

const c3de_host *hostOfSeam = nullptr;

c3de_status C3DE_CALL keepHost(const c3de_host *host, void **self) {
  hostOfSeam = host;
  *self = nullptr;
  return C3DE_OK;
}
c3de_status C3DE_CALL doNothing(void *) { return C3DE_OK; }
void C3DE_CALL end(void *) { hostOfSeam = nullptr; }

const c3de_plugin kSeam{sizeof(c3de_plugin),
                        1,
                        {"test.fuzz", 9},
                        {"1.0.0", 5},
                        {"Fuzz", 4},
                        {"", 0},
                        {"", 0},
                        nullptr,
                        0,
                        0,
                        keepHost,
                        doNothing,
                        doNothing,
                        end};

template <class R, class Context, class... Arguments>
bool callWith(R(C3DE_CALL *function)(Context *, Arguments...), Context *context, BoundaryValues &values) {
  if (function == nullptr) return false;
  values.beginCall();
  std::tuple<Arguments...> arguments{values.make<Arguments>()...};
  bool isTaken = true;
  std::apply(
      [&](Arguments... each) {
        if constexpr (std::is_same_v<R, c3de_status>)
          isTaken = function(context, each...) >= 0;
        else
          (void)function(context, each...);
      },
      arguments);
  // A created handle is used again later.
  std::apply(
      [&](Arguments... each) {
        (void)std::initializer_list<int>{[&](auto argument) {
          if constexpr (std::is_same_v<decltype(argument), c3de_handle *>)
            if (argument != nullptr) values.remember(*argument);
          return 0;
        }(each)...};
      },
      arguments);
  return isTaken;
}

struct Call {
  const char *name;
  bool (*run)(const c3de_host *host, BoundaryValues &values);
};

/// Whether the host has performed the request.
template <class Table, auto Slot>
bool callSlot(const c3de_host *host, BoundaryValues &values) {
  constexpr std::string_view id = c3de::sdk::kTableId<Table>;
  const void *found = nullptr;
  if (host->get_service(host->ctx, {id.data(), id.size()}, 1, &found) < 0) return false;
  const auto *table = static_cast<const Table *>(found);
  return callWith(table->*Slot, table->ctx, values);
}

constexpr Call kCalls[] = {
#define CALL(table, slot) Call{#table "." #slot, &callSlot<table, &table::slot>},
#include "service_calls.inc"
#undef CALL
};

template <class Table>
const Table &tableOf(const c3de_host *host) {
  constexpr std::string_view id = c3de::sdk::kTableId<Table>;
  const void *found = nullptr;
  if (host->get_service(host->ctx, {id.data(), id.size()}, 1, &found) < 0) std::exit(2);
  return *static_cast<const Table *>(found);
}

/// One of everything that has a handle or a name, so that calls find existing objects.
void prepare(c3de::validate::TrialHost &host, BoundaryValues &values) {
  const auto &mesh = tableOf<c3de_mesh_v1>(hostOfSeam);
  const auto &collision = tableOf<c3de_collision_v1>(hostOfSeam);
  const auto &scene = tableOf<c3de_scene_v1>(hostOfSeam);
  const auto &render = tableOf<c3de_render_v1>(hostOfSeam);
  const auto &params = tableOf<c3de_params_v1>(hostOfSeam);
  const auto &registry = tableOf<c3de_registry_v1>(hostOfSeam);
  static constexpr std::array kPoints{0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  static constexpr std::array<float, 12> kColours{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  static constexpr std::array<std::uint32_t, 12> kTriangles{0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  const c3de_view points{kPoints.data(), 4, 3, C3DE_F64, 0}, triangles{kTriangles.data(), 4, 3, C3DE_U32, 0},
      colours{kColours.data(), 4, 3, C3DE_F32, 0};
  const auto keep = [&](c3de_status status, c3de_handle handle, const char *what) {
    if (status < 0) {
      std::fprintf(stderr, "fuzz_services: %s is refused\n", what);
      std::exit(2);
    }
    if (handle.v != 0) values.keep(handle);
  };
  c3de_handle made{}, node{};
  keep(mesh.create(mesh.ctx, points, triangles, &made), made, "a mesh");
  keep(collision.create(collision.ctx, points, triangles, &made), made, "a tree");
  keep(scene.add_node(scene.ctx, {0}, {"node", 4}, &node), node, "a node");
  const c3de_material material{sizeof material, 0, {1, 0, 0, 1}, 0};
  keep(render.create_mesh(render.ctx, node, points, triangles, &material, &made), made, "a mesh to draw");
  keep(render.create_spheres(render.ctx, node, points, 1.0, &material, &made), made, "spheres");
  keep(render.create_lines(render.ctx, node, points, 1.0f, &material, &made), made, "lines");
  keep(render.create_label(render.ctx, node, kPoints.data(), {"label", 5}, &material, &made), made, "a label");
  const c3de_legend legend{sizeof legend, 0, {"u", 1}, {"mm", 2}, {"", 0}, 0.0, 1.0, colours};
  keep(render.create_legend(render.ctx, node, &legend, &made), made, "a legend");
  c3de_param_decl decl{};
  decl.size = sizeof decl;
  decl.type = C3DE_PARAM_F64;
  decl.id = {"strength", 8};
  decl.label = {"Strength", 8};
  decl.max = 1.0;
  decl.soft_max = 1.0;
  keep(params.declare(params.ctx, {"Fuzz", 4}, &decl, 1, sizeof decl, nullptr, &made), made, "parameters");
  const c3de_class cls{sizeof cls,
                       1,
                       {"test.fuzz.B", 11},
                       {"B", 1},
                       {"", 0},
                       nullptr,
                       0,
                       nullptr,
                       [](void *, c3de_object **out) -> c3de_status {
                         *out = BoundaryValues::object();
                         return C3DE_OK;
                       }};
  keep(registry.add_class(registry.ctx, &cls), {}, "a class");

  const auto image = std::make_shared<c3de::scene::StoredImage>();
  image->name = "image";
  image->volume.geometry.size = {2, 2, 2};
  image->volume.geometry.indexToWorld = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  image->volume.voxels = std::vector<std::int16_t>(8, 7);
  values.keep(c3de_handle{host.images.add(std::shared_ptr<const c3de::scene::StoredImage>(image)).bits()});
  const auto labels = std::make_shared<c3de::scene::StoredLabels>();
  labels->name = "labels";
  labels->map.geometry = image->volume.geometry;
  labels->map.voxels.assign(8, 3);
  labels->map.labels = {{3, "liver", {0.5f, 0.25f, 0.0f}}};
  values.keep(c3de_handle{host.images.add(std::shared_ptr<const c3de::scene::StoredLabels>(labels)).bits()});
}

/// Ends the process or causes endless work by contract, with these arguments.
bool isLeftOut(std::string_view name) {
  return name == "c3de_jobs_v1.parallel_for" ||  // with 2^63 parts it makes that many calls
         name == "c3de_mesh_v1.load";            // names of devices
}

std::filesystem::path settingsFolder(std::uint64_t seed) {
  return std::filesystem::temp_directory_path() / ("c3de-fuzz-" + std::to_string(seed));
}

/// The life cycle of one host, some thousand calls long.
std::uint64_t live(std::uint64_t seed, bool isVerbose, std::vector<std::uint64_t> &taken) {
  BoundaryValues values(seed);
  for (const char *text : {"test.fuzz.B", "organ", "C3DE", "x,y", "strength"}) values.remember(std::string(text));
  c3de::validate::TrialHost host(settingsFolder(seed));
  if (const std::string refusal = host.refusalOf(C3DE_SEAM); !refusal.empty()) {
    std::fprintf(stderr, "fuzz_services: the seam is refused: %s\n", refusal.c_str());
    std::exit(2);
  }
  prepare(host, values);
  std::uint64_t done = 0;
  for (int i = 0; i < 3000; ++i) {
    const Call &call = kCalls[values.below(std::size(kCalls))];
    if (isLeftOut(call.name)) continue;
    if (isVerbose) std::fprintf(stderr, "%d %s\n", i, call.name);
    const bool isTaken = call.run(hostOfSeam, values);
    taken[static_cast<std::size_t>(&call - kCalls)] += isTaken ? 1u : 0u;
    ++done;
    if (i % 50 == 49) {
      host.mainQueue.runFrame();
      c3de::registry::TextPanel text(&host.parameters);
      for (const c3de::Handle panel : host.panels.handles())
        if (const auto *found = host.panels.find(panel)) (void)text.draw(*found);
      host.host->syncScene();
      values.forget();
    }
  }
  return done;
}

}  // namespace

int main(int argc, char **argv) {
  c3de::installFatalErrorReport();
  double seconds = 10.0;
  std::uint64_t seed = static_cast<std::uint64_t>(Clock::now().time_since_epoch().count());
  bool isOnce = false;
  CLI::App app("Random calls of the host's services.");
  app.add_option("--seconds", seconds, "For how long");
  app.add_option("--seed", seed, "Of the first life");
  app.add_flag("--once", isOnce, "One life of this seed, with each call");
  CLI11_PARSE(app, argc, argv);
  char where[32];
  std::snprintf(where, sizeof where, "%llx", static_cast<unsigned long long>(reinterpret_cast<std::uintptr_t>(&kSeam)));
  setenv("C3DE_TEST_DESCRIPTOR", where, 1);
  const auto begin = Clock::now();
  std::uint64_t lives = 0, calls = 0;
  std::vector<std::uint64_t> taken(std::size(kCalls));
  do {
    // Before it, so that the seed of a run that ends the process is known.
    std::fprintf(stderr, "\rfuzz_services: seed %llu ", static_cast<unsigned long long>(seed + lives));
    calls += live(seed + lives, isOnce, taken);
    ++lives;
  } while (!isOnce && std::chrono::duration<double>(Clock::now() - begin).count() < seconds);
  std::uint64_t done = 0;
  std::string never;
  for (std::size_t i = 0; i < taken.size(); ++i) {
    done += taken[i];
    if (taken[i] == 0) never += std::string(never.empty() ? "" : ", ") + kCalls[i].name;
  }
  std::printf("\n%llu calls of %zu functions in %llu lives, %llu of them taken, first seed %llu: no finding\n",
              static_cast<unsigned long long>(calls), std::size(kCalls), static_cast<unsigned long long>(lives),
              static_cast<unsigned long long>(done), static_cast<unsigned long long>(seed));
  if (!never.empty()) std::printf("never taken: %s\n", never.c_str());
  return 0;
}
