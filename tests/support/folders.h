// SPDX-License-Identifier: Apache-2.0
// Folders of the source and build tree. In functions, so that tests compile to the same wherever the tree lies.
#pragma once

const char *testDataFolder();       ///< organs and scans made by others; may be absent
const char *testResourcesFolder();  ///< resources/ of the source tree
const char *testOutputRoot();       ///< what tests leave behind
const char *testPluginFolder();     ///< plugins of the build
const char *testExampleFolder();    ///< example plugins of the build
