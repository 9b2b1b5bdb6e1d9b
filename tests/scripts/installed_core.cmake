cmake_minimum_required(VERSION 3.25)
# -DBUILD=… -DPLACE=… -DCOMPILERS=… -DHEADERS=…: that a third-party program builds with the installed core (component pointbased)
# and nothing but the prefix: the batch example agrees with the beam formula, pkg-config reports what is needed, the
# library has no variable that several users would share, and a package without it reports what to install. With HEADERS every public
# header compiles on its own.
include("${CMAKE_CURRENT_LIST_DIR}/run.cmake")

set(prefix "${PLACE}/prefix")
file(REMOVE_RECURSE "${PLACE}")
install_component("${BUILD}" sdk "${prefix}")

# The component is asked for before it is there.
file(WRITE "${PLACE}/missing/CMakeLists.txt" "cmake_minimum_required(VERSION 3.23)\nproject(missing LANGUAGES CXX)\nfind_package(C3DE REQUIRED COMPONENTS PointBased)\n")
execute_process(COMMAND "${CMAKE_COMMAND}" -G Ninja -S "${PLACE}/missing" -B "${PLACE}/missing/build" "-DCMAKE_PREFIX_PATH=${prefix}"
  RESULT_VARIABLE code OUTPUT_QUIET ERROR_VARIABLE errors)
if(code EQUAL 0 OR NOT errors MATCHES "PointBased is not installed in")
  message(SEND_ERROR "a package without PointBased is to say so:\n${errors}")
endif()
install_component("${BUILD}" pointbased "${prefix}")

foreach(compiler IN LISTS COMPILERS)
  string(REPLACE "+" "_" name "${compiler}")
  build_outside("${prefix}/share/c3de/examples/batch" "${PLACE}/${name}" "${prefix}" "${compiler}" Release)
  run("${PLACE}/${name}/batch")
  message(STATUS "${compiler}:\n${output}")
  if(NOT output MATCHES "quasi-static +tip" OR NOT output MATCHES "explicit +tip")
    message(SEND_ERROR "the batch program was to show both solutions")
  endif()
endforeach()
list(GET COMPILERS 0 compiler)
if(HEADERS)
  file(GLOB headers RELATIVE "${prefix}/include" "${prefix}/include/pointbased/*.h")
  list(LENGTH headers count)
  if(count LESS 30)
    message(SEND_ERROR "${count} headers of the core are installed")
  endif()
  set(sources)
  foreach(header IN LISTS headers)
    string(MAKE_C_IDENTIFIER "${header}" name)
    file(WRITE "${PLACE}/headers/${name}.cpp" "#include \"${header}\"\n")
    list(APPEND sources ${name}.cpp)
  endforeach()
  list(JOIN sources " " sources)
  file(WRITE "${PLACE}/headers/CMakeLists.txt" "cmake_minimum_required(VERSION 3.23)\nproject(headers LANGUAGES CXX)\n"
    "find_package(C3DE REQUIRED COMPONENTS PointBased)\nadd_library(headers OBJECT ${sources})\n"
    "target_link_libraries(headers PRIVATE c3de::pointbased)\n"
    "target_compile_options(headers PRIVATE -Wall -Wextra -Wpedantic -Werror -fsyntax-only)\n")
  # -fsyntax-only writes no object files, so Ninja stops after compiling and nothing is linked.
  run("${CMAKE_COMMAND}" -E env --unset=CXXFLAGS "${CMAKE_COMMAND}" -G Ninja -S "${PLACE}/headers" -B "${PLACE}/headers/build"
      "-DCMAKE_PREFIX_PATH=${prefix}" "-DCMAKE_CXX_COMPILER=${compiler}")
  run("${CMAKE_COMMAND}" --build "${PLACE}/headers/build")
endif()

file(GLOB library "${prefix}/lib*/libc3de_pointbased.a" "${prefix}/lib*/*/libc3de_pointbased.a")
run(nm -C --defined-only "${library}")
string(REGEX MATCHALL "[^\n]* [BbCD] [^\n]*" variables "${output}")
# Who is told of a broken precondition (precondition.h), and of each thread whether it is within a loop.
list(FILTER variables EXCLUDE REGEX "::chosenHandler$|::insideLoop$")
if(variables)
  list(JOIN variables "\n" variables)
  message(SEND_ERROR "variables of the library that outlive a call:\n${variables}")
endif()

find_program(PKG_CONFIG pkg-config)
if(PKG_CONFIG)
  cmake_path(GET library PARENT_PATH folder)
  run("${CMAKE_COMMAND}" -E env "PKG_CONFIG_PATH=${folder}/pkgconfig" "${PKG_CONFIG}" --cflags --libs --static c3de-pointbased)
  string(STRIP "${output}" flags)
  separate_arguments(flags UNIX_COMMAND "${flags}")
  run("${compiler}" -std=c++20 -O2 "${prefix}/share/c3de/examples/batch/batch.cpp" -o "${PLACE}/by_pkg_config" ${flags})
  run("${PLACE}/by_pkg_config")
endif()
