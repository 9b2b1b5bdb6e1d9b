// SPDX-License-Identifier: Apache-2.0
// Loads correctly and then lets exceptions escape from every callback it has registered.
#include <stdexcept>

#include "minimal.h"

namespace {

void C3DE_CALL throwFromFrame(void *) { throw std::runtime_error("thrown in a frame"); }
void C3DE_CALL throwFromPost(void *) { throw std::runtime_error("thrown in a posted function"); }
void C3DE_CALL throwFromPanel(void *, const c3de_ui_v1 *) { throw std::runtime_error("thrown in a panel"); }
c3de_status C3DE_CALL throwFromTool(void *) { throw std::runtime_error("thrown in a tool"); }
void C3DE_CALL cancelTool(void *) {}
c3de_status C3DE_CALL toolEvent(void *, const c3de_event *, uint32_t *) { return C3DE_OK; }
c3de_status C3DE_CALL throwFromJob(void *, const c3de_progress *) { throw std::runtime_error("thrown in a job"); }
void C3DE_CALL throwFromDone(void *, c3de_status, c3de_str) { throw std::runtime_error("thrown in done"); }
c3de_status C3DE_CALL throwFromClass(void *, c3de_object **) { throw std::runtime_error("thrown in a class"); }
void C3DE_CALL throwFromDestroy(void *) { throw std::runtime_error("thrown in destroy"); }

template <class Table>
const Table *service(const c3de_host *host, const char *id) {
  const void *table = nullptr;
  (void)host->get_service(host->ctx, text(id), 1, &table);
  return static_cast<const Table *>(table);
}

c3de_status C3DE_CALL create(const c3de_host *host, void **) {
  c3de_handle handle;
  const auto *time = service<c3de_time_v1>(host, C3DE_TIME_ID);
  (void)time->add_frame_callback(time->ctx, nullptr, &throwFromFrame, &handle);
  (void)time->post_to_main(time->ctx, nullptr, &throwFromPost);
  const auto *panels = service<c3de_panels_v1>(host, C3DE_PANELS_ID);
  const c3de_panel panel{sizeof(c3de_panel), 1, text("test.panel"), text("Test"), nullptr, &throwFromPanel};
  (void)panels->add(panels->ctx, &panel, &handle);
  const auto *tools = service<c3de_tools_v1>(host, C3DE_TOOLS_ID);
  const c3de_tool tool{sizeof(c3de_tool),
                       1,
                       text("test.tool"),
                       text("Test"),
                       text(""),
                       0,
                       0,
                       nullptr,
                       &throwFromTool,
                       &cancelTool,
                       &toolEvent,
                       0,
                       0};
  (void)tools->add(tools->ctx, &tool, &handle);
  const auto *jobs = service<c3de_jobs_v1>(host, C3DE_JOBS_ID);
  const c3de_job job{sizeof(c3de_job), 0, text("Test"), nullptr, &throwFromJob, &throwFromDone};
  (void)jobs->submit(jobs->ctx, &job, &handle);
  const auto *registry = service<c3de_registry_v1>(host, C3DE_REGISTRY_ID);
  const c3de_class cls{sizeof(c3de_class), 1, text("test.Thrower/0"), text(""), text(""), nullptr, 0, nullptr,
                       &throwFromClass};
  return registry->add_class(registry->ctx, &cls);
}

const c3de_plugin plugin = {NAMED("test.throws_later"), NO_NEEDS, &create, &do_nothing, &do_nothing, &throwFromDestroy};

}  // namespace

ANSWER_WITH(&plugin)
