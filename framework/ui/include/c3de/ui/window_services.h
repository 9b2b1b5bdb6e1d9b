// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "c3de/core/handle.h"
#include "c3de/ui/tissue_table.h"

namespace c3de::segmentation {
class ScanBody;
class SegmentationWorkflow;
}  // namespace c3de::segmentation

namespace c3de::registry {
class CommandRegistry;
class EditList;
class PanelRegistry;
class ParameterRegistry;
class ToolRegistry;
}  // namespace c3de::registry

namespace c3de {
class BackgroundJobs;
namespace scene {
class SceneGraph;
}
}  // namespace c3de

namespace c3de::ui {

class ImageViews;
class MaskBrush;
class MeasurementList;
class MeasurementTools;
struct MissingFiles;
class PlotList;
struct StartPage;

/// What the window shows; must outlive its last drawFrame(). Null members show nothing.
struct WindowServices {
  registry::PanelRegistry *panels = nullptr;
  registry::ToolRegistry *tools = nullptr;
  registry::ParameterRegistry *parameters = nullptr;
  scene::SceneGraph *scene = nullptr;
  BackgroundJobs *jobs = nullptr;
  ImageViews *images = nullptr;                            ///< while it has an image, slices are shown next to the 3D
                                                           ///< view
  segmentation::SegmentationWorkflow *workflow = nullptr;  ///< its steps are undone while they are the last edits
  const MaskBrush *brush = nullptr;                        ///< drawn in the slices while it is active
  segmentation::ScanBody *scanBody = nullptr;              ///< its dialog is drawn while it is shown
  TissueTable *tissues = nullptr;                          ///< a section of the side panel while it has rows
  registry::EditList *edits = nullptr;                     ///< of plugins; undone while they are the last edits
  registry::CommandRegistry *commands = nullptr;           ///< of plugins; a menu if there are any
  const StartPage *startPage = nullptr;                    ///< shown while there is nothing else
  std::function<std::string()> meshExtensions;             ///< for the dialog: "obj;stl"
  MissingFiles *missingFiles = nullptr;                    ///< its dialog is drawn while it is shown
  MeasurementList *measurements = nullptr;                 ///< a section of the side panel, and marks in the views
  MeasurementTools *measurementTools = nullptr;            ///< unfinished measurements are drawn
  PlotList *plots = nullptr;                               ///< curves of the strip below the views
  /// A panel that a command has opened: drawn before the others, and scrolled into view once. A null handle: none.
  std::function<Handle()> openedPanel;
};

}  // namespace c3de::ui
