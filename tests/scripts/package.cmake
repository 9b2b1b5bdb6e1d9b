cmake_minimum_required(VERSION 3.25)
# -DBUILD=… -DPLACE=… -DCOMPILER=…: what find_package(C3DE) accepts, and what the package says where it does not. Later and
# earlier packages are the installed one with another number in its version file.
include("${CMAKE_CURRENT_LIST_DIR}/run.cmake")

set(prefix "${PLACE}/prefix")
file(REMOVE_RECURSE "${PLACE}")
install_component("${BUILD}" sdk "${prefix}")
file(GLOB_RECURSE version_file "${prefix}/*/C3DEConfigVersion.cmake")
file(READ "${version_file}" version_text)
if(NOT version_text MATCHES "PACKAGE_VERSION \"([0-9.]+)\"")
  message(FATAL_ERROR "no version in ${version_file}")
endif()
set(version "${CMAKE_MATCH_1}")

# find(PACKAGE WANTED TEXT): configures a project with find_package(C3DE WANTED). TEXT: "" where it is to be found, else
# what the error has to contain.
set(count 0)
function(find package wanted text)
  math(EXPR count "${count} + 1")
  set(count ${count} PARENT_SCOPE)
  string(REPLACE "PACKAGE_VERSION \"${version}\"" "PACKAGE_VERSION \"${package}\"" changed "${version_text}")
  file(WRITE "${version_file}" "${changed}")
  set(source "${PLACE}/${count}")
  file(WRITE "${source}/CMakeLists.txt" "cmake_minimum_required(VERSION 3.23)\nproject(find LANGUAGES NONE)\nfind_package(C3DE ${wanted})\n")
  execute_process(COMMAND "${CMAKE_COMMAND}" -G Ninja -S "${source}" -B "${source}/build" "-DCMAKE_PREFIX_PATH=${prefix}"
    RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE output)
  string(REGEX REPLACE "[ \n]+" " " output "${output}")
  if(text STREQUAL "" AND NOT code EQUAL 0)
    message(SEND_ERROR "find_package(C3DE ${wanted}) was to find ${package}:\n${output}")
  elseif(NOT text STREQUAL "" AND (code EQUAL 0 OR NOT output MATCHES "${text}"))
    message(SEND_ERROR "find_package(C3DE ${wanted}) was to end with '${text}' for ${package}:\n${output}")
  endif()
endfunction()

foreach(package 0.1.0 0.2.3 0.10.0)
  foreach(wanted 0.1 "0.1...0.10" "0.1...<1" "0.1...1.0")
    find(${package} "${wanted} REQUIRED" "")
  endforeach()
endforeach()
find(0.1.0 "REQUIRED" "")
find(0.1.0 "0.1.0 EXACT REQUIRED COMPONENTS PluginSDK" "")
find(0.1.0 "0.1 REQUIRED OPTIONAL_COMPONENTS Rendering" "")
find(0.1.0 "0.2 REQUIRED" "0.2.*version: 0.1.0")
find(0.1.0 "1 REQUIRED" "version: 0.1.0")
find(0.3.0 "0.1...0.2 REQUIRED" "version: 0.3.0")
find(0.3.0 "0.1...<0.3 REQUIRED" "version: 0.3.0")
find(0.1.0 "REQUIRED COMPONENTS Rendering" "there is no component 'Rendering'. accepted: PluginSDK, PointBased")
find(0.1.0 "REQUIRED COMPONENTS PluginSDK pointbased" "there is no component 'pointbased'. accepted: PluginSDK, PointBased")
find(0.1.0 "REQUIRED COMPONENTS PointBased" "PointBased is not installed in")
file(WRITE "${version_file}" "${version_text}")

# The language of the headers comes with the target: a project that says none, and one whose default is older.
foreach(standard "" "set(CMAKE_CXX_STANDARD 11)")
  set(source "${PLACE}/standard")
  file(REMOVE_RECURSE "${source}")
  file(WRITE "${source}/includes.cpp" "#include <c3de/sdk/plugin.hpp>\n#include <c3de/sdk/services.hpp>\n")
  file(WRITE "${source}/CMakeLists.txt" "cmake_minimum_required(VERSION 3.23)\nproject(standard LANGUAGES CXX)\n${standard}\n"
    "find_package(C3DE 0.1 REQUIRED)\nadd_library(includes OBJECT includes.cpp)\ntarget_link_libraries(includes PRIVATE c3de::sdk)\n"
    "target_compile_options(includes PRIVATE -fsyntax-only)\n")
  run("${CMAKE_COMMAND}" -E env --unset=CXXFLAGS "${CMAKE_COMMAND}" -G Ninja -S "${source}" -B "${source}/build"
      "-DCMAKE_PREFIX_PATH=${prefix}" "-DCMAKE_CXX_COMPILER=${COMPILER}")
  run("${CMAKE_COMMAND}" --build "${source}/build")
endforeach()

foreach(document LICENSE NOTICE docs/plugin/index.md)
  if(NOT EXISTS "${prefix}/share/doc/c3de/${document}")
    message(SEND_ERROR "component sdk: ${document} is not installed")
  endif()
endforeach()
