#!/usr/bin/python3
"""Where catkin finds the Python package."""
from distutils.core import setup

from catkin_pkg.python_setup import generate_distutils_setup

setup(**generate_distutils_setup(packages=["kr3_common"], package_dir={"": "python"}))
