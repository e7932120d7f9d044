# cmake -DBINARY_DIR=.. -DSOURCE_DIR=.. -P deb_hidden_test.cmake
# The same with empty folders over the sources and the build.
include(${CMAKE_CURRENT_LIST_DIR}/deb_common.cmake)
set(apart "")
foreach(option --mount --map-root-user)  # the second, with the first, without being root
  list(APPEND apart ${option})
  execute_process(COMMAND unshare ${apart} mount -t tmpfs none ${BINARY_DIR}
    RESULT_VARIABLE refused OUTPUT_QUIET ERROR_VARIABLE reason)
  if(refused EQUAL 0)
    break()
  endif()
endforeach()
if(NOT refused EQUAL 0)
  skip("a mount namespace of its own is not allowed: ${reason}")
  return()
endif()
execute_process(COMMAND mktemp --directory --tmpdir strata-deb-XXXXXX
  OUTPUT_VARIABLE work OUTPUT_STRIP_TRAILING_WHITESPACE)
execute_process(COMMAND readlink /proc/self/ns/mnt
  OUTPUT_VARIABLE ours OUTPUT_STRIP_TRAILING_WHITESPACE)
run(cp -r ${deb}/root root)
# Its first line keeps the machine's own folders from being hidden, should unshare not have worked.
file(WRITE ${work}/hidden "test \"$(readlink /proc/self/ns/mnt)\" != '${ours}' || exit 1
set -e
mount -t tmpfs none '${BINARY_DIR}'
mount -t tmpfs none '${SOURCE_DIR}'
test ! -e '${SOURCE_DIR}/CMakeLists.txt'
test ! -e '${BINARY_DIR}/bin'
exec \"$@\"
")
try_program(${work}/root unshare ${apart} sh hidden)
file(REMOVE_RECURSE ${work})
