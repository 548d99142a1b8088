"""Installs Surefoot into a folder and builds the examples against it, as an independent project would."""
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
CMAKE = os.environ["CMAKE"]
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.M)


class Install(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="surefoot-install-")
        cls.addClassCleanup(folder.cleanup)
        cls.dir = pathlib.Path(folder.name)
        cls.prefix = cls.dir / "prefix"
        cls.call(CMAKE, "--install", os.environ["BUILD_DIR"], "--prefix", cls.prefix)

    @staticmethod
    def call(*words):
        ended = subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=1500)
        assert ended.returncode == 0, f"{words}\n{ended.stdout[-4000:]}\n{ended.stderr[-4000:]}"
        return ended.stdout

    def test_headers_are_complete_and_have_no_opencv(self):
        include = self.prefix / "include"
        headers = sorted(include.rglob("*.hpp"))
        self.assertGreater(len(headers), 100)
        self.assertIn(include / "surefoot/perception.hpp", headers)
        for header in headers:
            name = str(header.relative_to(include))
            self.assertFalse(name.endswith("_testing.hpp"), name)
            for quote, target in INCLUDE.findall(header.read_text()):
                self.assertFalse(target.startswith("opencv2/"), f"{name} includes {target}")
                if quote == '"':
                    self.assertTrue((include / target).is_file(), f"{name} includes {target}, which is not installed")

    def test_the_examples_build_against_it_and_run(self):
        build = self.dir / "examples"
        self.call(CMAKE, "-S", ROOT / "examples", "-B", build, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={self.prefix}",
                  f"-DCMAKE_CXX_COMPILER={os.environ['CXX']}", "-DCMAKE_CXX_COMPILER_LAUNCHER=ccache")
        self.call(CMAKE, "--build", build)
        self.assertIn("movement 9 (N)", self.call(build / "07_my_own_machine", "rex"))
        self.assertIn("cells known", self.call(build / "02_map_from_depth_images"))

    def test_another_project_takes_it_in_as_a_folder(self):
        project = self.dir / "project"
        project.mkdir()
        (project / "CMakeLists.txt").write_text(
            f"cmake_minimum_required(VERSION 3.25)\nproject(mine LANGUAGES CXX)\nadd_subdirectory({ROOT} surefoot)\n"
            "add_executable(mine main.cpp)\ntarget_link_libraries(mine PRIVATE surefoot::surefoot)\n"
            'if(CMAKE_CXX_STANDARD OR CMAKE_POSITION_INDEPENDENT_CODE OR CMAKE_EXPORT_COMPILE_COMMANDS)\n'
            '  message(FATAL_ERROR "a variable of Surefoot leaks into the project")\nendif()\n')
        (project / "main.cpp").write_text("#include <surefoot/surefoot.hpp>\nint main() {}\n")
        self.call(CMAKE, "-S", project, "-B", project / "build", "-G", "Ninja", f"-DCMAKE_CXX_COMPILER={os.environ['CXX']}")
        targets = self.call("ninja", "-C", project / "build", "-t", "targets", "all")
        self.assertNotIn("_test", targets)
        self.assertNotIn("surefoot-gate", targets)


if __name__ == "__main__":
    unittest.main()
