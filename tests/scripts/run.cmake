# For the scripts beside it. run(COMMAND …): ends the test where the command fails; what it printed is in `output`.
function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT code EQUAL 0)
    list(JOIN ARGV " " command)
    message(FATAL_ERROR "${command}\nends with ${code}:\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

# install_component(BUILD COMPONENT PREFIX [FOLDER])   The list of installed files goes to FOLDER; the one in the build folder is
# that of the last installation by hand again, which `uninstall` needs.
function(install_component build component prefix)
  set(manifest "${build}/install_manifest_${component}.txt")
  set(kept "${build}/CMakeFiles/kept_${component}.txt")
  file(REMOVE "${kept}")
  if(EXISTS "${manifest}")
    file(RENAME "${manifest}" "${kept}")
  endif()
  run("${CMAKE_COMMAND}" --install "${build}" --component ${component} --prefix "${prefix}")
  if(ARGC GREATER 3)
    file(COPY "${manifest}" DESTINATION "${ARGV3}")
  endif()
  file(REMOVE "${manifest}")
  if(EXISTS "${kept}")
    file(RENAME "${kept}" "${manifest}")
  endif()
endfunction()

# Configures and builds a project that sees the prefix alone, with every warning an error.
function(build_outside source build prefix compiler type)
  set(cc gcc)
  if(compiler MATCHES "clang")
    set(cc clang)
  endif()
  run("${CMAKE_COMMAND}" -E env --unset=CFLAGS --unset=CXXFLAGS "${CMAKE_COMMAND}" -G Ninja -S "${source}" -B "${build}"
      "-DCMAKE_PREFIX_PATH=${prefix}" "-DCMAKE_C_COMPILER=${cc}" "-DCMAKE_CXX_COMPILER=${compiler}"
      "-DCMAKE_BUILD_TYPE=${type}" "-DCMAKE_C_FLAGS=-Wall -Wextra -Wpedantic -Werror"
      "-DCMAKE_CXX_FLAGS=-Wall -Wextra -Wpedantic -Werror")
  run("${CMAKE_COMMAND}" --build "${build}")
endfunction()
