// SPDX-License-Identifier: Apache-2.0
// Folders of the source and build tree. In functions, so that tests compile to the same code wherever the tree is.
#pragma once

const char *testDataFolder();       ///< third-party organs and scans; may be absent
const char *testResourcesFolder();  ///< resources/ of the source tree
const char *testOutputRoot();       ///< output of the tests
const char *testPluginFolder();     ///< plugins of the build
const char *testExampleFolder();    ///< example plugins of the build
