"""How colcon builds this package."""

from setuptools import setup

setup(
    name="neurotouch_ros",
    version="0.1.0",
    packages=["neurotouch_ros"],
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/neurotouch_ros"]),
        ("share/neurotouch_ros", ["package.xml"]),
    ],
    install_requires=["setuptools"],
    license="MIT",
    entry_points={"console_scripts": ["publish = neurotouch_ros.publish:main"]},
)
