// SPDX-License-Identifier: Apache-2.0
// A separate program, because it replaces operator new: in steady state, the step of a body allocates no memory.
#include <atomic>
#include <cstdlib>
#include <new>

#ifdef _WIN32
#include <malloc.h>
#endif

#include "contact_cases.h"
#include "pointbased/lattice.h"
#include "shapes.h"
#include "support/catch.h"

namespace {

std::atomic<std::size_t> taken{0};

void *counted(void *p) {
  ++taken;
  if (!p) throw std::bad_alloc();
  return p;
}

#ifdef _WIN32  // without aligned_alloc()
void *aligned(std::size_t size, std::size_t alignment) { return _aligned_malloc(size, alignment); }
void freeAligned(void *p) { _aligned_free(p); }
#else
void *aligned(std::size_t size, std::size_t alignment) {
  // A multiple of the alignment is required.
  return std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
}
void freeAligned(void *p) { std::free(p); }
#endif

}  // namespace

void *operator new(std::size_t size) { return counted(std::malloc(size)); }
void *operator new(std::size_t size, std::align_val_t alignment) {
  return counted(aligned(size, static_cast<std::size_t>(alignment)));
}
void operator delete(void *p) noexcept { std::free(p); }
void operator delete(void *p, std::size_t) noexcept { std::free(p); }
void operator delete(void *p, std::align_val_t) noexcept { freeAligned(p); }

using namespace pointbased;
using namespace shapes;

namespace {

// A box that falls, hits the ground and has been in contact for a while; then checks that its steps allocate no memory.
void checkStepsOf(std::unique_ptr<Body> body, Precision precision) {
  Simulator simulator;
  simulator.setWorld({.gravity = Vec3(0, -9.81, 0),
                      .box = {.enabled = true, .min = Vec3(-1, 0, -1), .max = Vec3(1, 1, 1)},
                      .damping = 20.0,
                      .precision = precision});
  const std::size_t id = simulator.addBody(std::move(body));
  REQUIRE(simulator.body(id)->vectorised());
  for (int i = 0; i < 400; ++i) REQUIRE(simulator.step());
  REQUIRE_FALSE(simulator.body(id)->contact.active.empty());
  const std::size_t before = taken;
  bool gone = true;
  for (int i = 0; i < 100; ++i) gone = gone && simulator.step().has_value();
  const std::size_t after = taken;
  CHECK(gone);
  CHECK(after == before);
}

const Vec3 kLow(0.0, 0.01, 0.0), kHigh(0.2, 0.05, 0.04);  // m

}  // namespace

TEST_CASE("explicit steps take no memory, free and in contact, on lattices and in clouds, in both precisions") {
  const Material material = rubber(1e4, 1.0);
  for (const Precision precision : {Precision::doublePrecision, Precision::singlePrecision}) {
    INFO("lattice");
    checkStepsOf(latticeBox(kLow, kHigh, 0.01, material), precision);
  }
  for (const Precision precision : {Precision::doublePrecision, Precision::singlePrecision}) {
    INFO("cloud");
    checkStepsOf(shapes::makeBody(shapes::restState(shapes::box(kLow, kHigh), 0.01), {material}), precision);
  }
}

TEST_CASE("nor do those of a lattice that flows and relaxes") {
  Material material = rubber(1e4, 1.0);
  material.plastic.yield = 0.01;
  material.plastic.creep = 0.5;
  material.prony[0] = {0.3, 0.05};
  checkStepsOf(latticeBox(kLow, kHigh, 0.01, material), Precision::doublePrecision);
}
