// SPDX-License-Identifier: Apache-2.0
#include "scene_proxies.h"

#include <map>

#include "c3de/core/main_queue.h"
#include "c3de/plugin_host/plugin_host.h"
#include "c3de/render/renderer.h"
#include "c3de/scene/scene_graph.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::plugin_host;

namespace {

/// Records placement calls.
class RecordingRenderer : public render::Renderer {
 public:
  struct Placement {
    Mat4 transform = kIdentity4;
    bool visible = true;
  };
  std::map<std::uint64_t, Placement> placed;

  Handle add() {
    const Handle handle{static_cast<std::uint32_t>(placed.size()), ++generation_};
    placed[handle.bits()] = {};
    return handle;
  }
  Handle createMesh(std::span<const render::Vec3f>, std::span<const Triangle>, const render::Material &) override {
    return add();
  }
  Handle createSpheres(std::span<const render::Vec3f>, float, const render::Material &) override { return add(); }
  Handle createLines(std::span<const render::Vec3f>, float, const render::Material &) override { return add(); }
  Handle createLabel(const render::Vec3f &, std::string_view, const render::Material &) override { return add(); }
  Handle createLegend(const render::Legend &) override { return add(); }
  bool setPositions(Handle, std::span<const render::Vec3f>) override { return true; }
  bool setNormals(Handle, std::span<const render::Vec3f>) override { return true; }
  bool setColours(Handle, std::span<const render::Colour>) override { return true; }
  bool setRadii(Handle, std::span<const float>) override { return true; }
  bool setLabel(Handle, const render::Vec3f &, std::string_view) override { return true; }
  bool setLegend(Handle, const render::Legend &) override { return true; }
  bool setMaterial(Handle, const render::Material &) override { return true; }
  bool setTransform(Handle h, const Mat4 &worldFromProxy) override {
    placed.at(h.bits()).transform = worldFromProxy;
    return true;
  }
  bool setVisible(Handle h, bool visible) override {
    placed.at(h.bits()).visible = visible;
    return true;
  }
  bool destroy(Handle h) override { return placed.erase(h.bits()) > 0; }
  void setBackground(const Background &) override {}
  void draw(const render::Camera &, const render::Viewport &) override {}
  std::uint64_t changes() const override { return 0; }
  Expected<render::Image> drawToImage(const render::Camera &, int, int) override { return render::Image{}; }
  std::string description() const override { return "recording"; }

 private:
  std::uint32_t generation_ = 0;
};

struct Fixture {
  RecordingRenderer renderer;
  scene::SceneGraph graph;
  SceneProxies proxies{&renderer, &graph};
  Handle node = graph.add({}, "parent");
  Handle child = graph.add(node, "child");
  Handle drawn = renderer.add();
  Handle proxy = proxies.add({"plugin", child, drawn, ProxyKind::mesh, 3, 1.0f, true});

  [[nodiscard]] const RecordingRenderer::Placement &placement() const { return renderer.placed.at(drawn.bits()); }
};

}  // namespace

TEST_CASE("a proxy stands where its node stands, from the beginning and after it has moved") {
  Fixture f;
  CHECK(f.placement().transform == kIdentity4);
  f.graph.find(f.node)->parentFromNode[12] = 5.0;
  f.graph.find(f.child)->parentFromNode[13] = 7.0;
  f.proxies.sync();
  CHECK(f.placement().transform[12] == 5.0);
  CHECK(f.placement().transform[13] == 7.0);
}

TEST_CASE("a proxy is seen when its own switch and all nodes above say so") {
  Fixture f;
  f.graph.find(f.node)->visible = false;
  f.proxies.sync();
  CHECK_FALSE(f.placement().visible);
  f.graph.find(f.node)->visible = true;
  f.proxies.find(f.proxy)->visible = false;
  f.proxies.sync();
  CHECK_FALSE(f.placement().visible);
  f.proxies.find(f.proxy)->visible = true;
  f.proxies.sync();
  CHECK(f.placement().visible);
}

TEST_CASE("a proxy goes with its node") {
  Fixture f;
  f.graph.remove(f.node);
  CHECK(f.proxies.find(f.proxy) == nullptr);
  CHECK(f.renderer.placed.empty());
  Fixture g;
  g.graph.remove(g.node);
  g.proxies.sync();
  CHECK(g.proxies.size() == 0);
  CHECK(g.renderer.placed.empty());
}

TEST_CASE("the proxies of a plugin are removed, those of others stay") {
  Fixture f;
  const Handle other = f.proxies.add({"other", f.child, f.renderer.add(), ProxyKind::lines, 2, 1.0f, true});
  f.proxies.removeOwnedBy("plugin");
  CHECK(f.proxies.find(f.proxy) == nullptr);
  CHECK(f.proxies.find(other) != nullptr);
}

TEST_CASE("a host without anything to serve can be made and has no plugins") {
  PluginHost host(Services{});
  host.start();
  host.syncScene();
  CHECK(host.plugins().empty());
  CHECK(host.classes().empty());
  CHECK_FALSE(host.load("no/such/file.so"));
  CHECK(host.plugins().size() == 1);
}

TEST_CASE("a host leaves no frame callback behind") {
  MainQueue queue;
  {
    Services services;
    services.mainQueue = &queue;
    const PluginHost host(services);
  }
  queue.runFrame();
  CHECK(queue.frameIndex() == 1);
}
